//! Fuzz target of the reader `foreign_json_lines`.
#![no_main]
ddl_fuzz::target!("foreign_json_lines");
