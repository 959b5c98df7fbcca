//! Fuzz target of the reader `stream`.
#![no_main]
ddl_fuzz::target!("stream");
