//! Shared by all fuzz targets: an allocator that aborts at a single allocation above the limit.
//!
//! libFuzzer's `-malloc_limit_mb` sees allocations only if a sanitizer is built in; this allocator always sees those of
//! Rust.

use std::alloc::{GlobalAlloc, Layout, System};

/// The fuzz target of the reader of this name in `ddl_tests::outside_bytes`.
#[macro_export]
macro_rules! target {
    ($reader:literal) => {
        libfuzzer_sys::fuzz_target!(|bytes: &[u8]| ddl_tests::outside_bytes::read($reader, bytes));
    };
}

/// Largest single allocation of a reader of a small input, in bytes.
const MOST: usize = 64 << 20;

struct Bounded;

#[global_allocator]
static BOUNDED: Bounded = Bounded;

fn check(size: usize) {
    if size > MOST {
        eprintln!("a reader asked for {size} bytes at once");
        std::process::abort();
    }
}

// SAFETY: every call is forwarded unchanged to the system's allocator.
unsafe impl GlobalAlloc for Bounded {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        check(layout.size());
        // SAFETY: the caller keeps the contract of `alloc`.
        unsafe { System.alloc(layout) }
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        check(layout.size());
        // SAFETY: the caller keeps the contract of `alloc_zeroed`.
        unsafe { System.alloc_zeroed(layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        check(size);
        // SAFETY: the caller keeps the contract of `realloc`.
        unsafe { System.realloc(pointer, layout, size) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: the caller keeps the contract of `dealloc`.
        unsafe { System.dealloc(pointer, layout) }
    }
}
