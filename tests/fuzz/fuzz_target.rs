//! The fuzz target of every reader: the name of the program is that of the reader.
#![no_main]

use cap::Cap;
use std::alloc::System;

/// A reader of a small input must not ask for more memory. libFuzzer's `-malloc_limit_mb` sees allocations only if a
/// sanitizer is built in.
#[global_allocator]
static LIMITED: Cap<System> = Cap::new(System, 256 << 20);

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| ddl_tests::outside_bytes::read(env!("CARGO_BIN_NAME"), bytes));
