//! Fuzz target of the reader `model_files::experts::read`.
#![no_main]
ddl_fuzz::target!(model_files::experts::read);
