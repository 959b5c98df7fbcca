//! The files of a log.

use crate::error::LogError;
use std::path::{Path, PathBuf};

/// What rosbag2 writes beside the files of a recording.
const METADATA: &str = "metadata.yaml";

/// Whether a path is that of a log: an MCAP file or a bag of `SQLite` by its extension, or the folder of a rosbag2
/// recording.
pub fn is_log(path: &Path) -> bool {
    has_extension(path, "mcap") || has_extension(path, "db3") || path.join(METADATA).is_file()
}

/// Whether a file is named as MCAP.
pub fn is_mcap(path: &Path) -> bool {
    has_extension(path, "mcap")
}

fn has_extension(path: &Path, wanted: &str) -> bool {
    path.extension()
        .is_some_and(|extension| extension.eq_ignore_ascii_case(wanted))
}

/// The MCAP files of a log, in the order of their names.
pub(crate) fn files(path: &Path) -> Result<Vec<PathBuf>, LogError> {
    let unreadable = |source| LogError::Read {
        path: path.to_owned(),
        source,
    };
    let mut files = vec![path.to_owned()];
    if path.is_dir() {
        let entries = path.read_dir().map_err(unreadable)?;
        let entries: Result<Vec<_>, _> = entries.map(|entry| entry.map(|entry| entry.path())).collect();
        files = entries.map_err(unreadable)?;
    }
    let is_sqlite = files.iter().any(|file| has_extension(file, "db3"));
    files.retain(|file| is_mcap(file));
    // bag_10 follows bag_9.
    files.sort_by_key(|file| (file.as_os_str().len(), file.clone()));
    match (files.is_empty(), is_sqlite) {
        (false, _) => Ok(files),
        (true, true) => Err(LogError::at(
            path.display().to_string(),
            "a bag of SQLite; write it as MCAP first (pip install rosbags; rosbags-convert --src BAG --dst NEW \
             --dst-storage mcap)",
        )),
        (true, false) => Err(LogError::at(
            path.display().to_string(),
            "the folder holds no file that ends in .mcap; unpack files that are compressed as a whole",
        )),
    }
}
