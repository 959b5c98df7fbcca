//! Fuzz target of the reader `live_tracks::read`.
#![no_main]
ddl_fuzz::target!(live_tracks::read);
