//! Fuzz target of the reader `homography`.
#![no_main]
ddl_fuzz::target!("homography");
