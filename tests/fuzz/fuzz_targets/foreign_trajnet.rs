#![no_main]
ddl_fuzz::target!(external::read_trajnet);
