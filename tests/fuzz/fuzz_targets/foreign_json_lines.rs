#![no_main]
ddl_fuzz::target!(external::read_json_lines);
