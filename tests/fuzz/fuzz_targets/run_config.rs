//! Fuzz target of the reader `run_config`.
#![no_main]
ddl_fuzz::target!("run_config");
