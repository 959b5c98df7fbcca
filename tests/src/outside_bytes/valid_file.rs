//! A valid file whose header holds a SHA-256 of its contents, and edits of it.

use super::edits::edited;
use arbitrary::Unstructured;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

pub(super) struct ValidFile<T> {
    /// What the file is read with.
    pub(super) with: T,
    path: PathBuf,
    bytes: Vec<u8>,
    /// Makes an edited file pass the check of its digest, to test the code after it.
    repair: fn(&[u8]) -> Option<Vec<u8>>,
    _folder: TempDir,
}

impl<T> ValidFile<T> {
    /// The file of this name that `write` writes to a new folder.
    pub(super) fn new(name: &str, repair: fn(&[u8]) -> Option<Vec<u8>>, write: impl FnOnce(&Path) -> T) -> Self {
        let folder = tempfile::tempdir().expect("a folder can be made");
        let path = folder.path().join(name);
        let with = write(&path);
        let bytes = std::fs::read(&path).expect("the file was written");
        assert!(repair(&bytes).is_some(), "{name} has a digest");
        Self { with, path, bytes, repair, _folder: folder }
    }

    /// Reads edits of the file; the first byte decides whether they are repaired. With at most one byte nothing is
    /// edited. An error must name the file.
    pub(super) fn read<R, E: std::fmt::Display>(
        &self,
        choices: &[u8],
        read: impl FnOnce(&T, &Path) -> Result<R, E>,
    ) -> Result<R, E> {
        let (way, edits) = choices.split_first().unwrap_or((&0, &[]));
        let mut file = edited(&mut Unstructured::new(edits), &self.bytes);
        if way & 1 == 1 {
            file = (self.repair)(&file).unwrap_or(file);
        }
        let outcome = with_file(&self.path, &file, |path| read(&self.with, path));
        if let Err(error) = &outcome {
            assert!(!edits.is_empty(), "a valid file: {error}");
            names_file(error, &self.path.display().to_string());
        }
        outcome
    }
}

pub(super) fn with_file<T>(path: &Path, bytes: &[u8], read: impl FnOnce(&Path) -> T) -> T {
    std::fs::write(path, bytes).expect("the file can be written");
    read(path)
}

pub(super) fn names_file(error: &impl std::fmt::Display, name: &str) {
    assert!(error.to_string().contains(name), "{error}");
}
