#![no_main]
ddl_fuzz::target!(model_files::json::read_metrics);
