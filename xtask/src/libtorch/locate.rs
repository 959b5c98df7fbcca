//! Checks whether a folder holds the libtorch version of this workspace.

use super::VERSION;
use anyhow::{Context, Result, ensure};
use std::env::consts::{DLL_PREFIX, DLL_SUFFIX};
use std::fs;
use std::path::Path;

/// A header that exists only in a libtorch with its C++ interface.
const HEADER: &str = "include/torch/csrc/api/include/torch/torch.h";

/// Checks files and version, but no hashes. The reason is a clause for a sentence.
pub(super) fn validate(folder: &Path) -> Result<()> {
    ensure!(folder.is_dir(), "the folder does not exist");
    for library in ["torch", "torch_cpu", "c10"] {
        let file = format!("lib/{DLL_PREFIX}{library}{DLL_SUFFIX}");
        ensure!(folder.join(&file).exists(), "it has no {file}");
    }
    let has_header = folder.join(HEADER).is_file();
    ensure!(has_header, "it has no {HEADER} (libraries without headers)");
    let found = version(folder).context("neither build-version nor version.py states its version")?;
    // A build of the same version for another backend, as in 2.11.0+cu130, has the same interface.
    ensure!(found.split('+').next() == Some(VERSION), "it is libtorch {found}");
    Ok(())
}

/// From `build-version` (a libtorch archive) or `version.py` (PyTorch's Python package).
fn version(folder: &Path) -> Option<String> {
    if let Ok(text) = fs::read_to_string(folder.join("build-version")) {
        return Some(text.trim().to_owned());
    }
    let module = fs::read_to_string(folder.join("version.py")).ok()?;
    module.lines().find_map(|line| line.strip_prefix("__version__"))?.split(['\'', '"']).nth(1).map(str::to_owned)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cache::write_file;

    #[test]
    fn both_kinds_of_folder_are_accepted_and_others_are_refused_with_a_reason() {
        let library = |name: &str| format!("lib/{DLL_PREFIX}{name}{DLL_SUFFIX}");
        for (version_file, contents, missing, reason) in [
            ("build-version", "2.11.0\n", "", ""),
            ("version.py", "__version__ = '2.11.0+cu130'\ncuda = '13.0'\n", "", ""),
            ("build-version", "2.7.0", "", "it is libtorch 2.7.0"),
            // A longer version with the same beginning is a different one.
            ("version.py", "__version__ = '2.11.01'", "", "it is libtorch 2.11.01"),
            ("NOTES", "", "", "neither build-version nor version.py"),
            ("build-version", VERSION, HEADER, "torch.h"),
            ("build-version", VERSION, &library("torch_cpu"), "torch_cpu"),
        ] {
            let folder = tempfile::tempdir().unwrap();
            let files = ["torch", "torch_cpu", "c10"].map(library).into_iter();
            for file in files.chain([HEADER.to_owned()]).filter(|file| file != missing) {
                write_file(&folder.path().join(file), b"").unwrap();
            }
            write_file(&folder.path().join(version_file), contents.as_bytes()).unwrap();
            let message = validate(folder.path()).err().map_or_else(String::new, |error| error.to_string());
            let is_right = message.is_empty() == reason.is_empty() && message.contains(reason);
            assert!(is_right, "{message}");
        }
        let message = validate(Path::new("/nowhere/libtorch")).unwrap_err();
        assert_eq!(message.to_string(), "the folder does not exist");
    }
}
