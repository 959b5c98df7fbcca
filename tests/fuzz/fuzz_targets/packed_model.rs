//! Fuzz target of the reader `model_files::packed_model::read`.
#![no_main]
ddl_fuzz::target!(model_files::packed_model::read);
