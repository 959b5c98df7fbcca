//! Fuzz target of the reader `own_tracks::read`.
#![no_main]
ddl_fuzz::target!(own_tracks::read);
