//! The files of a log.

use crate::error::LogError;
use std::path::{Path, PathBuf};

/// Whether a path is that of a log: an MCAP file or a bag of `SQLite` by its extension, or the folder of a rosbag2
/// recording.
pub fn is_log(path: &Path) -> bool {
    is_mcap(path) || is_sqlite(path) || path.join("metadata.yaml").is_file()
}

/// Whether a file is named as MCAP.
pub fn is_mcap(path: &Path) -> bool {
    path.extension().is_some_and(|it| it.eq_ignore_ascii_case("mcap"))
}

fn is_sqlite(path: &Path) -> bool {
    path.extension().is_some_and(|it| it.eq_ignore_ascii_case("db3"))
}

/// The MCAP files of a log, in order.
pub(crate) fn files(path: &Path) -> Result<Vec<PathBuf>, LogError> {
    let place = path.display();
    let mut files = vec![path.to_owned()];
    if path.is_dir() {
        let entries = path
            .read_dir()
            .map_err(|error| LogError::at(&place)(error.to_string()))?;
        files = entries.flatten().map(|entry| entry.path()).collect();
    }
    let sqlite = files.iter().any(|file| is_sqlite(file));
    files.retain(|file| is_mcap(file));
    if files.is_empty() {
        return Err(LogError::at(&place)(if sqlite {
            "a bag of SQLite; write it as MCAP first (pip install rosbags; rosbags-convert --src BAG --dst NEW \
             --dst-storage mcap)"
                .to_owned()
        } else {
            "no file in it ends in .mcap; unpack files that are compressed as a whole".to_owned()
        }));
    }
    // bag_10 follows bag_9.
    files.sort_by_key(|file| (file.as_os_str().len(), file.clone()));
    Ok(files)
}
