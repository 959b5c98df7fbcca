//! Fuzz target of the reader `table`.
#![no_main]
ddl_fuzz::target!("table");
