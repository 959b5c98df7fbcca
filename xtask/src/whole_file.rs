//! Atomic writing of files, in folders that are created if necessary.

use std::fs;
use std::path::Path;

use anyhow::{Context, Result};

pub(crate) fn write(path: &Path, bytes: &[u8]) -> Result<()> {
    path.parent()
        .map_or(Ok(()), fs::create_dir_all)
        .and_then(|()| ddl_data::write_atomically(path, bytes))
        .with_context(|| format!("{} cannot be written", path.display()))
}
