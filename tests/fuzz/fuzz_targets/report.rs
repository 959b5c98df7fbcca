//! Fuzz target of the reader `report::read`.
#![no_main]
ddl_fuzz::target!(report::read);
