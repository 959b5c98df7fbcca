//! Whether a folder holds the libtorch that this workspace is made for.

use std::env::consts::{DLL_PREFIX, DLL_SUFFIX};
use std::fs;
use std::path::Path;

use super::pin::VERSION;

/// A header that only a libtorch with its C++ interface has.
const HEADER: &str = "include/torch/csrc/api/include/torch/torch.h";

/// Checks files and version, not hashes; the reason is a clause for a sentence.
pub(super) fn validate(folder: &Path) -> Result<(), String> {
    if !folder.is_dir() {
        return Err("there is no such folder".to_owned());
    }
    for library in ["torch", "torch_cpu", "c10"] {
        let file = format!("lib/{DLL_PREFIX}{library}{DLL_SUFFIX}");
        if !folder.join(&file).exists() {
            return Err(format!("it holds no {file}"));
        }
    }
    if !folder.join(HEADER).is_file() {
        return Err(format!("it holds no {HEADER} (libraries without headers)"));
    }
    match version(folder) {
        // A build of the same version for another backend, as in 2.11.0+cu130, has the same
        // interface.
        Some(found) if found.split('+').next() == Some(VERSION) => Ok(()),
        Some(found) => Err(format!("it is libtorch {found}")),
        None => Err("neither build-version nor version.py tells its version".to_owned()),
    }
}

/// From `build-version` (a libtorch archive) or `version.py` (PyTorch's Python package).
fn version(folder: &Path) -> Option<String> {
    if let Ok(text) = fs::read_to_string(folder.join("build-version")) {
        return Some(text.trim().to_owned());
    }
    let module = fs::read_to_string(folder.join("version.py")).ok()?;
    let value = module
        .lines()
        .find_map(|line| line.strip_prefix("__version__"))?;
    value.split(['\'', '"']).nth(1).map(str::to_owned)
}

#[cfg(test)]
mod tests {
    use super::*;
    use tempfile::TempDir;

    fn libtorch(version_file: &str, contents: &str) -> TempDir {
        let folder = tempfile::tempdir().unwrap();
        for library in ["torch", "torch_cpu", "c10"] {
            let file = format!("lib/{DLL_PREFIX}{library}{DLL_SUFFIX}");
            write(folder.path(), &file, "");
        }
        write(folder.path(), HEADER, "");
        write(folder.path(), version_file, contents);
        folder
    }

    fn write(folder: &Path, file: &str, contents: &str) {
        let path = folder.join(file);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, contents).unwrap();
    }

    #[test]
    fn both_kinds_of_folder_are_accepted() {
        validate(libtorch("build-version", "2.11.0\n").path()).unwrap();
        validate(
            libtorch(
                "version.py",
                "__version__ = '2.11.0+cu130'\ncuda = '13.0'\n",
            )
            .path(),
        )
        .unwrap();
    }

    #[test]
    fn another_version_is_refused_by_name() {
        let reason = validate(libtorch("build-version", "2.7.0").path()).unwrap_err();
        assert_eq!(reason, "it is libtorch 2.7.0");
        // A longer version that merely begins the same is another one.
        let reason = validate(libtorch("version.py", "__version__ = '2.11.01'").path());
        assert_eq!(reason.unwrap_err(), "it is libtorch 2.11.01");
    }

    #[test]
    fn an_unknown_version_is_refused() {
        let reason = validate(libtorch("NOTES", "").path()).unwrap_err();
        assert!(reason.contains("build-version"), "{reason}");
    }

    #[test]
    fn missing_pieces_are_named() {
        let folder = libtorch("build-version", "2.11.0");
        fs::remove_file(folder.path().join(HEADER)).unwrap();
        assert!(validate(folder.path()).unwrap_err().contains("torch.h"));
        let library = format!("lib/{DLL_PREFIX}torch_cpu{DLL_SUFFIX}");
        fs::remove_file(folder.path().join(&library)).unwrap();
        assert_eq!(
            validate(folder.path()).unwrap_err(),
            format!("it holds no {library}")
        );
        let gone = folder.path().join("gone");
        assert_eq!(validate(&gone).unwrap_err(), "there is no such folder");
    }

    #[cfg(unix)]
    #[test]
    fn a_dangling_link_is_no_library() {
        let folder = libtorch("build-version", "2.11.0");
        let library = folder
            .path()
            .join(format!("lib/{DLL_PREFIX}torch{DLL_SUFFIX}"));
        fs::remove_file(&library).unwrap();
        std::os::unix::fs::symlink("nowhere.so", &library).unwrap();
        assert!(validate(folder.path()).is_err());
    }
}
