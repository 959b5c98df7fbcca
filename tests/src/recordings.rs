//! The real recordings, where they can be had.

use ddl_data::{Convention, locate};
use std::path::PathBuf;

/// The folder of the `star` recordings, or `None` with the reason printed if they are not on this
/// machine.
pub fn star_folder() -> Option<PathBuf> {
    match locate(Convention::Star, None) {
        Ok(folder) => Some(folder),
        Err(error) if std::env::var_os("CI").is_some_and(|value| !value.is_empty()) => {
            panic!("CI needs the real recordings: {error}")
        }
        Err(error) => {
            eprintln!("skipped: {error}");
            None
        }
    }
}
