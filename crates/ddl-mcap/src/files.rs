//! The files of a log.

use crate::error::LogError;
use serde_json::Value;
use std::path::{Path, PathBuf};

/// What a rosbag2 recording consists of.
const METADATA: &str = "metadata.yaml";

/// Whether a path is that of a log: an MCAP file or a bag of `SQLite` by its extension, or the folder of a rosbag2
/// recording.
pub fn is_log(path: &Path) -> bool {
    is_mcap(path) || is_sqlite(path) || path.join(METADATA).is_file()
}

/// Whether a file is named as MCAP.
pub fn is_mcap(path: &Path) -> bool {
    path.extension().is_some_and(|it| it.eq_ignore_ascii_case("mcap"))
}

fn is_sqlite(path: &Path) -> bool {
    path.extension().is_some_and(|it| it.eq_ignore_ascii_case("db3"))
}

/// The first file of a recording that its list names and that is not there.
fn missing_part(folder: &Path) -> Result<Option<String>, String> {
    let wrong = |error: &dyn std::error::Error| format!("{METADATA}: {error}");
    let text = std::fs::read_to_string(folder.join(METADATA)).map_err(|error| wrong(&error))?;
    let list: Value = serde_saphyr::from_str(&text).map_err(|error| wrong(&error))?;
    let names = list["rosbag2_bagfile_information"]["relative_file_paths"].as_array();
    let names = names.into_iter().flatten().filter_map(Value::as_str);
    let mut missing = names.filter(|name| !folder.join(name).exists());
    Ok(missing.next().map(str::to_owned))
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
        let missing = missing_part(path).map_err(|problem| LogError::at(&place)(problem))?;
        if let Some(name) = missing {
            let problem = format!("{METADATA} lists {name}, which is missing; bring it back, or name one of the files");
            return Err(LogError::at(&place)(problem));
        }
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
