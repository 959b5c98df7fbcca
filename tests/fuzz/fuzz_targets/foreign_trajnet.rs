//! Fuzz target of the reader `foreign_trajnet`.
#![no_main]
ddl_fuzz::target!("foreign_trajnet");
