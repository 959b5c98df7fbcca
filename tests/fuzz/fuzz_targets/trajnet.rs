//! Fuzz target of the reader `trajnet`.
#![no_main]
ddl_fuzz::target!("trajnet");
