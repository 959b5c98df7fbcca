//! The real recordings, if they are available.

use crate::skip::skip;
use ddl_data::{Convention, Dataset, locate};
use std::path::PathBuf;

/// The folder of the `star` recordings, or `None` if they are not on this machine.
pub fn star_folder() -> Option<PathBuf> {
    locate(Convention::Star, None).map_or_else(skip, Some)
}

/// The recordings of a convention, as [`star_folder`].
pub fn dataset(convention: Convention) -> Option<Dataset> {
    let folder = locate(convention, None).map_or_else(skip, Some)?;
    Some(Dataset::load(convention, &folder).expect("the recordings can be read"))
}
