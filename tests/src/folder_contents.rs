//! The contents of a folder, to check that a command wrote nothing, or the same bytes again.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// Every file below a folder with its bytes (a link with its target), and every folder with `None`, by relative path.
pub type Contents = BTreeMap<PathBuf, Option<Vec<u8>>>;

/// Reads everything below `folder`.
pub fn read(folder: &Path) -> Contents {
    let mut contents = Contents::new();
    let mut waiting = vec![folder.to_owned()];
    while let Some(next) = waiting.pop() {
        let entries = std::fs::read_dir(&next).expect("the folder can be listed");
        for entry in entries {
            let entry = entry.expect("the folder can be listed");
            let (path, kind) = (entry.path(), entry.file_type().expect("the kind of a file"));
            let relative = path.strip_prefix(folder).unwrap_or(&path).to_owned();
            let content = if kind.is_dir() {
                waiting.push(path);
                None
            } else if kind.is_symlink() {
                Some(std::fs::read_link(&path).expect("the link can be read").into_os_string().into_encoded_bytes())
            } else if kind.is_file() {
                Some(std::fs::read(&path).expect("the file can be read"))
            } else {
                // A pipe is not opened: that would wait for a writer.
                Some(Vec::new())
            };
            contents.insert(relative, content);
        }
    }
    contents
}

/// Writes contents to `folder`, which is created if necessary.
pub fn write(contents: &Contents, folder: &Path) {
    std::fs::create_dir_all(folder).expect("the folder can be made");
    for (relative, bytes) in contents {
        let path = folder.join(relative);
        match bytes {
            None => std::fs::create_dir_all(&path).expect("the folder can be made"),
            Some(bytes) => std::fs::write(&path, bytes).expect("the file can be written"),
        }
    }
}

/// Asserts that nothing differs; the message names what does, and does not print megabytes.
pub fn assert_same(before: &Contents, after: &Contents) {
    let names: BTreeSet<&PathBuf> = before.keys().chain(after.keys()).collect();
    let differ = |name: &&PathBuf| before.get(*name) != after.get(*name);
    let different: Vec<_> = names.into_iter().filter(differ).collect();
    assert!(different.is_empty(), "new, gone or changed: {different:?}");
}

/// Files with temporary names anywhere below a folder: unfinished files.
pub fn half_written(folder: &Path) -> Vec<String> {
    let marks = [".writing-", ".report-", ".tmp"];
    let names = read(folder).into_keys().map(|name| name.display().to_string());
    names.filter(|name| marks.iter().any(|mark| name.contains(mark))).collect()
}
