#![no_main]
ddl_fuzz::target!(live_tracks::read);
