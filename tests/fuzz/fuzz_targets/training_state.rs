//! Fuzz target of the reader `training_state`.
#![no_main]
ddl_fuzz::target!("training_state");
