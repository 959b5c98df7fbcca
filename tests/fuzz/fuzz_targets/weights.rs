//! Fuzz target of the reader `weights`.
#![no_main]
ddl_fuzz::target!("weights");
