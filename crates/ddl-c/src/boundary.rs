//! From C to Rust and back: pointers are checked, errors and panics become a status with words.

#![allow(unsafe_code, reason = "arrays and texts of C")]

use crate::layout::ddl_status;
use std::cell::RefCell;
use std::error::Error;
use std::ffi::{CStr, CString, c_char};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Why a call failed.
#[derive(Debug)]
pub(crate) struct CallFailure(ddl_status, String);

impl CallFailure {
    /// What was passed is wrong.
    pub(crate) fn invalid(error: impl Into<Box<dyn Error>>) -> Self {
        Self(ddl_status::INVALID, ddl::with_causes(&*error.into()))
    }

    /// A file is missing, unreadable or wrong.
    pub(crate) fn file(error: impl Into<Box<dyn Error>>) -> Self {
        Self(ddl_status::FILE, ddl::with_causes(&*error.into()))
    }
}

thread_local! {
    static LAST_ERROR: RefCell<CString> = RefCell::default();
}

/// The words of the last failure on this thread, which stay in place until the next; empty before the first.
pub(crate) fn last_error() -> *const c_char {
    LAST_ERROR.try_with(|last| last.borrow().as_ptr()).unwrap_or(c"".as_ptr())
}

/// Text for C, where a zero byte ends it.
pub(crate) fn c_text(text: &str) -> CString {
    CString::new(text.replace('\0', " ")).unwrap_or_default()
}

/// Runs the body of a function of C: no panic leaves it.
pub(crate) fn guarded(work: impl FnOnce() -> Result<(), CallFailure>) -> ddl_status {
    let CallFailure(status, words) = match catch_unwind(AssertUnwindSafe(work)) {
        Ok(Ok(())) => return ddl_status::OK,
        Ok(Err(failure)) => failure,
        Err(panic) => {
            let words = panic.downcast_ref::<String>().map(String::as_str);
            let words = words.or_else(|| panic.downcast_ref::<&str>().copied()).unwrap_or_default();
            CallFailure(ddl_status::DEFECT, format!("a defect of the library: {words}"))
        }
    };
    // A thread that ends has no place for words.
    let _ = LAST_ERROR.try_with(|last| *last.borrow_mut() = c_text(&words));
    status
}

/// An argument that must not be null.
pub(crate) fn needed<T>(argument: Option<T>, name: &str) -> Result<T, CallFailure> {
    argument.ok_or_else(|| CallFailure::invalid(format!("{name} is null")))
}

/// The `count` values at this address; the pointer may be null if `count` is 0.
///
/// # Safety
/// `first` is null or points to `count` initialised values, which no thread writes during the call.
pub(crate) unsafe fn values<'a, T>(first: *const T, count: usize, name: &str) -> Result<&'a [T], CallFailure> {
    if count == 0 {
        return Ok(&[]);
    }
    needed((!first.is_null()).then_some(()), name)?;
    let bytes = size_of::<T>().checked_mul(count);
    if bytes.is_none_or(|bytes| bytes > isize::MAX as usize) || !first.is_aligned() {
        return Err(CallFailure::invalid(format!("{name}: no {count} values are at this address")));
    }
    // SAFETY: not null, aligned, of a size that exists; the rest is the caller's.
    Ok(unsafe { std::slice::from_raw_parts(first, count) })
}

/// A text; `None` for null.
///
/// # Safety
/// `first` is null or points to a string that ends with a zero byte.
pub(crate) unsafe fn text<'a>(first: *const c_char, name: &str) -> Result<Option<&'a str>, CallFailure> {
    if first.is_null() {
        return Ok(None);
    }
    // SAFETY: not null; the rest is the caller's.
    let text = unsafe { CStr::from_ptr(first) }.to_str();
    text.map(Some).map_err(|_| CallFailure::invalid(format!("{name} is not UTF-8")))
}
