//! Fuzz target of the reader `model_files::training_state::read`.
#![no_main]
ddl_fuzz::target!(model_files::training_state::read);
