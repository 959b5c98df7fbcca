//! Fuzz target of the reader `live_tracks`.
#![no_main]
ddl_fuzz::target!("live_tracks");
