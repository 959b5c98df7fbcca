//! Fuzz target of the reader `foreign_table`.
#![no_main]
ddl_fuzz::target!("foreign_table");
