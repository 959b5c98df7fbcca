//! A valid file of numbers with their SHA-256 in its header, and edits of it.

use std::path::{Path, PathBuf};

use serde_json::Value;
use tempfile::TempDir;

use super::{names_file, with_file};
use crate::outside_bytes::edits::Choices;
use crate::safetensors_file;

pub(super) struct Sound<T> {
    pub(super) with: T,
    pub(super) path: PathBuf,
    whole: Vec<u8>,
    /// The file in the layout of earlier versions, without the SHA-256 of its numbers. It tests the code after that
    /// check.
    without: Vec<u8>,
    _folder: TempDir,
}

impl<T> Sound<T> {
    /// The file of this name that `make` writes to a new folder.
    pub(super) fn new(name: &str, make: impl FnOnce(&Path) -> T) -> Self {
        let folder = tempfile::tempdir().expect("a folder can be made");
        let path = folder.path().join(name);
        let with = make(&path);
        let whole = std::fs::read(&path).expect("the file was written");
        Self {
            with,
            without: without_digest(&whole),
            whole,
            path,
            _folder: folder,
        }
    }

    /// Reads edits of the file in one of its layouts, chosen by the first byte; with at most one byte nothing is
    /// edited. An error must name the file.
    pub(super) fn read<R, E: std::fmt::Display>(
        &self,
        bytes: &[u8],
        read: impl FnOnce(&T, &Path) -> Result<R, E>,
    ) -> Result<R, E> {
        let file = match bytes.split_first() {
            None => self.whole.clone(),
            Some((way, edits)) if way & 1 == 0 => Choices::edited(edits, &self.whole),
            Some((_, edits)) => Choices::edited(edits, &self.without),
        };
        let outcome = with_file(&self.path, &file, |path| read(&self.with, path));
        if let Err(error) = &outcome {
            assert!(bytes.len() > 1, "a valid file: {error}");
            names_file(error, &self.path.display().to_string());
        }
        outcome
    }
}

fn without_digest(file: &[u8]) -> Vec<u8> {
    let (mut header, numbers) = safetensors_file::parts(file).expect("a valid file");
    let origin = &mut header["__metadata__"]["origin"];
    let facts = origin.as_str().map(serde_json::from_str::<Value>);
    let mut facts = facts.expect("a valid origin").expect("a valid origin");
    let all = facts.as_object_mut().expect("a valid origin");
    assert!(all.remove("numbers.sha256").is_some(), "the file has a digest");
    *origin = facts.to_string().into();
    safetensors_file::join(&header, numbers)
}
