//! Fuzz target of the reader `tracks::trajnet`.
#![no_main]
ddl_fuzz::target!(tracks::trajnet);
