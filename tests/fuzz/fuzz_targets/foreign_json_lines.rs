//! Fuzz target of the reader `external::read_json_lines`.
#![no_main]
ddl_fuzz::target!(external::read_json_lines);
