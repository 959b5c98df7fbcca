//! Fuzz target of the reader `goal_library`.
#![no_main]
ddl_fuzz::target!("goal_library");
