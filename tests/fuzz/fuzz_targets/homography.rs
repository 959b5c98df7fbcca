#![no_main]
ddl_fuzz::target!(homography::read);
