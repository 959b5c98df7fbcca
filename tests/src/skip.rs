//! What cannot be tried on this machine.

use std::fmt::Display;

/// Says that something is skipped, and why. Where the variable `CI` is set it fails: there, nothing may be skipped silently.
pub fn skip<T>(reason: impl Display) -> Option<T> {
    let in_ci = std::env::var_os("CI").is_some_and(|value| !value.is_empty());
    assert!(!in_ci, "CI skips nothing: {reason}");
    eprintln!("skipped: {reason}");
    None
}
