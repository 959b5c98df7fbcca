//! Fuzz target of the reader `scene_memory`.
#![no_main]
ddl_fuzz::target!("scene_memory");
