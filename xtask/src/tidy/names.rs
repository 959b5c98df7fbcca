//! A file is named after its one concept.

use std::path::{Path, PathBuf};

use super::Findings;

/// Names that say nothing about what is inside.
const EMPTY_NAMES: [&str; 9] = [
    "utils", "util", "common", "helpers", "helper", "misc", "stuff", "tools", "shared",
];

pub(super) fn check(files: &[PathBuf], findings: &mut Findings) {
    for file in files {
        if let Some(name) = empty_name(file) {
            findings.fault(format!(
                "{}: {name:?} says nothing: name it after its one concept",
                file.display()
            ));
        }
    }
}

/// The file's name or that of a folder above it, if it says nothing.
fn empty_name(file: &Path) -> Option<&str> {
    let stem = file.file_stem();
    let folders = file.parent().into_iter().flat_map(Path::iter);
    folders
        .chain(stem)
        .filter_map(|name| name.to_str())
        .find(|name| EMPTY_NAMES.contains(name))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_that_say_nothing_are_found_in_files_and_folders() {
        for file in ["crates/a/src/utils.rs", "helpers.py", "docs/misc/page.md"] {
            assert!(empty_name(Path::new(file)).is_some(), "{file}");
        }
        for file in [
            "crates/a/src/window.rs",
            "src/utilisation.rs",
            "common_law.rs",
        ] {
            assert!(empty_name(Path::new(file)).is_none(), "{file}");
        }
    }
}
