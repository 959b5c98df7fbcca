//! Fuzz target of the reader `tracks::obsmat`.
#![no_main]
ddl_fuzz::target!(tracks::obsmat);
