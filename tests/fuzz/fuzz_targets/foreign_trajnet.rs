//! Fuzz target of the reader `external::read_trajnet`.
#![no_main]
ddl_fuzz::target!(external::read_trajnet);
