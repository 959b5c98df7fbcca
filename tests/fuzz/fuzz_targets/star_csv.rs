//! Fuzz target of the reader `tracks::star_csv`.
#![no_main]
ddl_fuzz::target!(tracks::star_csv);
