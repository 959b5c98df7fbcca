//! Fuzz target of the reader `packed_model`.
#![no_main]
ddl_fuzz::target!("packed_model");
