#![no_main]
ddl_fuzz::target!(tracks::trajnet);
