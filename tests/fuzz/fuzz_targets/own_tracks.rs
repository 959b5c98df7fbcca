#![no_main]
ddl_fuzz::target!(own_tracks::read);
