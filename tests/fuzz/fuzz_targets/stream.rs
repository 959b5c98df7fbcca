#![no_main]
ddl_fuzz::target!(stream::read);
