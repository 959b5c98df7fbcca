//! Fuzz target of the reader `report`.
#![no_main]
ddl_fuzz::target!("report");
