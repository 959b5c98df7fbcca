//! `metrics.jsonl`.

use ddl::RunDirectory;
use tempfile::TempDir;

use super::{names_file, with_file};

/// Bytes as they are.
///
/// # Panics
/// When an error does not name the file.
pub fn read(bytes: &[u8]) {
    thread_local! {
        static FOLDER: TempDir = tempfile::tempdir().expect("a folder can be made");
    }
    FOLDER.with(|folder| {
        let run = RunDirectory::new(folder.path());
        let path = folder.path().join("metrics.jsonl");
        if let Err(error) = with_file(&path, bytes, |_| run.metrics()) {
            names_file(&error, "metrics.jsonl");
        }
    });
}
