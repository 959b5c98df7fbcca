#![no_main]
ddl_fuzz::target!(model_files::packed_model::read);
