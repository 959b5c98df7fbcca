//! Fuzz target of the reader `external::read_table`.
#![no_main]
ddl_fuzz::target!(external::read_table);
