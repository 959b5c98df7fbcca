//! Fuzz target of the reader `moments`.
#![no_main]
ddl_fuzz::target!("moments");
