//! Fuzz target of the reader `goal_library::read`.
#![no_main]
ddl_fuzz::target!(goal_library::read);
