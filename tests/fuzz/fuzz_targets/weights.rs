#![no_main]
ddl_fuzz::target!(model_files::weights::read);
