//! Fuzz target of the reader `stream::read`.
#![no_main]
ddl_fuzz::target!(stream::read);
