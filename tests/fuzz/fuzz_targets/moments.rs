#![no_main]
ddl_fuzz::target!(report::read_moments);
