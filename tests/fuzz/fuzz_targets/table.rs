//! Fuzz target of the reader `tracks::table`.
#![no_main]
ddl_fuzz::target!(tracks::table);
