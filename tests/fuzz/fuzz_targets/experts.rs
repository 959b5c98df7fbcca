//! Fuzz target of the reader `experts`.
#![no_main]
ddl_fuzz::target!("experts");
