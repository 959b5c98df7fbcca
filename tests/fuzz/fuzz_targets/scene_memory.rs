//! Fuzz target of the reader `scene_memory::read`.
#![no_main]
ddl_fuzz::target!(scene_memory::read);
