//! Fuzz target of the reader `model_files::json::read_metrics`.
#![no_main]
ddl_fuzz::target!(model_files::json::read_metrics);
