//! Fuzz target of the reader `model_files::json::read_run_config`.
#![no_main]
ddl_fuzz::target!(model_files::json::read_run_config);
