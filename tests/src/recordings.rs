//! The real recordings, if they are available.

use crate::skip::skip;
use ddl_data::{Convention, locate};
use std::path::PathBuf;

/// The folder of the `star` recordings, or `None` if they are not on this machine.
pub fn star_folder() -> Option<PathBuf> {
    locate(Convention::Star, None).map_or_else(skip, Some)
}
