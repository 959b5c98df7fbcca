//! Fuzz target of the reader `tracks::social_gan`.
#![no_main]
ddl_fuzz::target!(tracks::social_gan);
