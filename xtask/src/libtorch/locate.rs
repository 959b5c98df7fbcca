//! Checks whether a folder holds the libtorch version of this workspace.

use std::env::consts::{DLL_PREFIX, DLL_SUFFIX};
use std::fs;
use std::path::Path;

use super::pin::VERSION;

/// A header that exists only in a libtorch with its C++ interface.
const HEADER: &str = "include/torch/csrc/api/include/torch/torch.h";

/// Checks files and version, but no hashes. The reason is a clause for a sentence.
pub(super) fn validate(folder: &Path) -> Result<(), String> {
    if !folder.is_dir() {
        return Err("the folder does not exist".to_owned());
    }
    for library in ["torch", "torch_cpu", "c10"] {
        let file = format!("lib/{DLL_PREFIX}{library}{DLL_SUFFIX}");
        if !folder.join(&file).exists() {
            return Err(format!("it has no {file}"));
        }
    }
    if !folder.join(HEADER).is_file() {
        return Err(format!("it has no {HEADER} (libraries without headers)"));
    }
    match version(folder) {
        // A build of the same version for another backend, as in 2.11.0+cu130, has the same interface.
        Some(found) if found.split('+').next() == Some(VERSION) => Ok(()),
        Some(found) => Err(format!("it is libtorch {found}")),
        None => Err("neither build-version nor version.py states its version".to_owned()),
    }
}

/// From `build-version` (a libtorch archive) or `version.py` (PyTorch's Python package).
fn version(folder: &Path) -> Option<String> {
    if let Ok(text) = fs::read_to_string(folder.join("build-version")) {
        return Some(text.trim().to_owned());
    }
    let module = fs::read_to_string(folder.join("version.py")).ok()?;
    let value = module.lines().find_map(|line| line.strip_prefix("__version__"))?;
    value.split(['\'', '"']).nth(1).map(str::to_owned)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::whole_file;

    fn reason(version_file: &str, contents: &str, missing: &str) -> Result<(), String> {
        let folder = tempfile::tempdir().unwrap();
        let libraries = ["torch", "torch_cpu", "c10"];
        let libraries = libraries.map(|name| format!("lib/{DLL_PREFIX}{name}{DLL_SUFFIX}"));
        let empty = libraries.iter().map(String::as_str).chain([HEADER]);
        for (file, text) in empty.map(|file| (file, "")).chain([(version_file, contents)]) {
            if file != missing {
                whole_file::write(&folder.path().join(file), text.as_bytes()).unwrap();
            }
        }
        validate(folder.path())
    }

    #[test]
    fn both_kinds_of_folder_are_accepted_and_other_versions_are_refused_by_name() {
        assert_eq!(reason("build-version", "2.11.0\n", ""), Ok(()));
        let python = "__version__ = '2.11.0+cu130'\ncuda = '13.0'\n";
        assert_eq!(reason("version.py", python, ""), Ok(()));
        for (file, contents, version) in [
            ("build-version", "2.7.0", "2.7.0"),
            // A longer version with the same beginning is a different one.
            ("version.py", "__version__ = '2.11.01'", "2.11.01"),
        ] {
            let message = format!("it is libtorch {version}");
            assert_eq!(reason(file, contents, ""), Err(message));
        }
        assert!(reason("NOTES", "", "").unwrap_err().contains("build-version"));
    }

    #[test]
    fn missing_files_are_reported() {
        let missing = |file: &str| reason("build-version", VERSION, file).unwrap_err();
        assert!(missing(HEADER).contains("torch.h"));
        let library = format!("lib/{DLL_PREFIX}torch_cpu{DLL_SUFFIX}");
        assert_eq!(missing(&library), format!("it has no {library}"));
        let gone = validate(Path::new("/nowhere/libtorch")).unwrap_err();
        assert_eq!(gone, "the folder does not exist");
    }
}
