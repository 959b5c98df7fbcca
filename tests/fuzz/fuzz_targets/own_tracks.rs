//! Fuzz target of the reader `own_tracks`.
#![no_main]
ddl_fuzz::target!("own_tracks");
