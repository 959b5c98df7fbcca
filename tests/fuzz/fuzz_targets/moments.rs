//! Fuzz target of the reader `report::read_moments`.
#![no_main]
ddl_fuzz::target!(report::read_moments);
