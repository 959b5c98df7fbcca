//! Fuzz target of the reader `metrics`.
#![no_main]
ddl_fuzz::target!("metrics");
