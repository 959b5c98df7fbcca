//! The files of a log.

use crate::error::{LogError, LogProblem};
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

/// The files that the metadata of a recording lists, in their order.
fn listed(folder: &Path) -> Result<Vec<PathBuf>, LogProblem> {
    let wrong = |error: &dyn std::error::Error| format!("{METADATA}: {error}");
    let text = std::fs::read_to_string(folder.join(METADATA)).map_err(|error| wrong(&error))?;
    let list: Value = serde_saphyr::from_str(&text).map_err(|error| wrong(&error))?;
    let names = list["rosbag2_bagfile_information"]["relative_file_paths"].as_array();
    let names = names.into_iter().flatten().filter_map(Value::as_str);
    let file = |name: &str| {
        // Files that were compressed as a whole may be unpacked beside their old names.
        let unpacked = name.strip_suffix(".zstd").map(|name| folder.join(name));
        let file = unpacked.filter(|file| file.exists()).unwrap_or(folder.join(name));
        let missing = || format!("{METADATA} lists {name}, which is missing; bring it back, or name one of the files");
        file.exists().then_some(file).ok_or_else(missing)
    };
    Ok(names.map(file).collect::<Result<_, _>>()?)
}

/// The MCAP files of a log, in order, and a note on those in its folder that do not belong to it.
pub(crate) fn files(path: &Path) -> Result<(Vec<PathBuf>, Option<String>), LogError> {
    files_of(path).map_err(|problem| problem.at(path.display()))
}

fn files_of(path: &Path) -> Result<(Vec<PathBuf>, Option<String>), LogProblem> {
    let (mut files, mut others) = (vec![path.to_owned()], Vec::new());
    if path.is_dir() {
        files = listed(path)?;
        others = path.read_dir()?.flatten().map(|entry| entry.path()).collect();
        others.retain(|file| is_mcap(file) && !files.contains(file));
    }
    let sqlite = files.iter().any(|file| is_sqlite(file));
    files.retain(|file| is_mcap(file));
    if files.is_empty() {
        return Err(if sqlite {
            "a bag of SQLite; write it as MCAP first (pip install rosbags; rosbags-convert --src BAG --dst NEW \
             --dst-storage mcap)"
                .into()
        } else {
            format!("{METADATA} lists no file that ends in .mcap; unpack files that are compressed as a whole").into()
        });
    }
    let note = others.first().map(|other| {
        let (count, name) = (others.len(), other.display());
        format!("MCAP files that {METADATA} does not list are not read: {count}, first {name}")
    });
    Ok((files, note))
}
