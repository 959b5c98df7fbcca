//! Fuzz target of the reader `social_gan`.
#![no_main]
ddl_fuzz::target!("social_gan");
