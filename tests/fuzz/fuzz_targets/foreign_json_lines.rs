#![no_main]

use ddl_fuzz as _;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| ddl_tests::outside_bytes::external::read_json_lines(bytes));
