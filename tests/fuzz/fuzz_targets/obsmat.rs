//! Fuzz target of the reader `obsmat`.
#![no_main]
ddl_fuzz::target!("obsmat");
