//! Fuzz target of the reader `model_files::weights::read`.
#![no_main]
ddl_fuzz::target!(model_files::weights::read);
