//! Fuzz target of the reader `star_csv`.
#![no_main]
ddl_fuzz::target!("star_csv");
