//! Files of a few numbers, which are read whole.

use anyhow::{Context as _, bail};
use std::fs::File;
use std::io::Read as _;
use std::path::Path;

const MOST_BYTES: u64 = 1 << 24;

/// The text of a homography, a recipe or plans, of at most 16 megabytes: another file may be endless.
///
/// # Errors
/// Names the file that is larger or cannot be read.
pub(crate) fn read(path: &Path) -> anyhow::Result<String> {
    let unreadable = || format!("cannot read {}", path.display());
    let mut text = String::new();
    let file = File::open(path).with_context(unreadable)?;
    let read = file.take(MOST_BYTES + 1).read_to_string(&mut text);
    if read.with_context(unreadable)? as u64 > MOST_BYTES {
        bail!("{}: more than 16 megabytes; is it another file?", path.display());
    }
    Ok(text)
}
