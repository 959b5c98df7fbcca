//! Fuzz target of the reader `homography::read`.
#![no_main]
ddl_fuzz::target!(homography::read);
