//! The files of a log.

use crate::error::{LogError, LogProblem};
use granit_parser::{Event, Parser, ScanError};
use std::path::{Path, PathBuf};

/// What a rosbag2 recording consists of.
const METADATA: &str = "metadata.yaml";
/// Where its files are in that.
const FILES: [&str; 2] = ["rosbag2_bagfile_information", "relative_file_paths"];

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
    let names = texts_at(&text, &FILES).map_err(|error| wrong(&error))?;
    let file = |name: &str| {
        // Files that were compressed as a whole may be unpacked beside their old names.
        let unpacked = name.strip_suffix(".zstd").map(|name| folder.join(name));
        let file = unpacked.filter(|file| file.exists()).unwrap_or(folder.join(name));
        let missing = || format!("{METADATA} lists {name}, which is missing; bring it back, or name one of the files");
        file.exists().then_some(file).ok_or_else(missing)
    };
    Ok(names.iter().map(|name| file(name)).collect::<Result<_, _>>()?)
}

/// The texts of the sequence that these keys lead to. Of a whole YAML document only this is kept, so that the depth of
/// a file needs no stack.
fn texts_at(yaml: &str, keys: &[&str]) -> Result<Vec<String>, ScanError> {
    // For each mapping and sequence that is open: whether it is a mapping, and the key whose value comes next.
    let mut open: Vec<(bool, Option<String>)> = Vec::new();
    let mut texts = Vec::new();
    for event in Parser::new_from_str(yaml) {
        let text = match event?.0 {
            Event::Scalar(text, ..) => text.into_owned(),
            Event::MappingStart(..) => {
                open.push((true, None));
                continue;
            }
            Event::SequenceStart(..) => {
                open.push((false, None));
                continue;
            }
            Event::MappingEnd | Event::SequenceEnd => {
                open.pop();
                String::new()
            }
            Event::Alias(_) => String::new(),
            _ => continue,
        };
        match open.last_mut() {
            // A key, or the end of its value.
            Some((true, key)) => *key = if key.is_none() { Some(text) } else { None },
            Some((false, _)) => {
                let (sequence, path) = (open.len() - 1, open.iter().map(|(_, key)| key.as_deref()));
                if path.take(sequence).eq(keys.iter().copied().map(Some)) {
                    texts.push(text);
                }
            }
            None => (),
        }
    }
    Ok(texts)
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

#[cfg(test)]
mod tests {
    use super::texts_at;

    #[test]
    fn the_list_is_found_among_other_keys_in_each_style_of_yaml() {
        let found = |yaml: &str| texts_at(yaml, &["bag", "files"]).ok();
        let names = Some(vec!["a b.mcap".to_owned(), "c.mcap".to_owned()]);
        assert_eq!(found("{x: {files: [no]}, bag: {[files]: [no], files: [a b.mcap, 'c.mcap'], files2: [no]}}"), names);
        let block =
            "# rosbag2\nbag:\n  version: 9\n  topics:\n    - files: [no]\n  files:\n    - a b.mcap\n    - c.mcap\n";
        assert_eq!(found(&format!("{block}  duration:\n    nanoseconds: 1\nfiles: [no]\n")), names);
        let others =
            ["", "bag: files", "files: [no]", "bag: [files, [no]]", "- bag: {files: [no]}", "bag: {files: {a: b}}"];
        assert!(others.into_iter().all(|yaml| found(yaml) == Some(Vec::new())));
        assert_eq!(found("bag: [1, 2"), None);
        assert!(texts_at(&"[".repeat(100_000), &[]).is_err());
    }
}
