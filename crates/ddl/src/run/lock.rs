//! Locks that let one process at a time work in a run or write a file.

use crate::error::DdlError;
use std::fs::{File, OpenOptions, TryLockError};
use std::io::ErrorKind;
use std::path::Path;

/// Name of the locked file. It stays, empty: removing it would break the lock of a waiting process.
const FILE: &str = ".lock";

/// The right to write into the directory of a run, or to a file. It is released when dropped; the system holds it for
/// the process. `None` inside stands for a read-only directory, or for a file system without locks.
#[derive(Debug)]
pub struct RunLock(#[allow(dead_code, reason = "held, never read")] Option<File>);

impl RunLock {
    /// Locks the directory without waiting.
    ///
    /// # Errors
    /// [`DdlError::Run`] when another process holds the lock.
    pub fn take(folder: &Path) -> Result<Self, DdlError> {
        let taken = "another process works in this directory; wait until it is done, or choose another directory";
        Self::take_by(&folder.join(FILE), || DdlError::run(folder, taken))
    }

    /// Locks one file without waiting, through a file beside it with the suffix `.lock`.
    ///
    /// # Errors
    /// [`DdlError::Run`] when another process holds the lock.
    pub(crate) fn take_file(path: &Path) -> Result<Self, DdlError> {
        let mut beside = path.as_os_str().to_owned();
        beside.push(FILE);
        let taken = "another process, or a watch of this process that was not closed, writes this file; wait until it \
                     is done, or choose another file";
        Self::take_by(Path::new(&beside), || DdlError::run(path, taken))
    }

    fn take_by(lock: &Path, taken: impl FnOnce() -> DdlError) -> Result<Self, DdlError> {
        let Some(file) = open(lock)? else {
            return Ok(Self(None));
        };
        match file.try_lock() {
            Ok(()) => Ok(Self(Some(file))),
            Err(TryLockError::WouldBlock) => Err(taken()),
            Err(TryLockError::Error(_)) => Ok(Self(None)),
        }
    }

    /// Waits for the lock of the directory, to write results of finished work.
    pub(crate) fn wait(folder: &Path) -> Result<Self, DdlError> {
        let file = open(&folder.join(FILE))?;
        Ok(Self(file.filter(|file| file.lock().is_ok())))
    }
}

fn open(path: &Path) -> Result<Option<File>, DdlError> {
    let file = OpenOptions::new().create(true).truncate(false).write(true).open(path);
    match file {
        Ok(file) => Ok(Some(file)),
        // A finished run in a read-only directory is still usable.
        Err(error) if matches!(error.kind(), ErrorKind::PermissionDenied | ErrorKind::ReadOnlyFilesystem) => Ok(None),
        Err(error) => Err(DdlError::io(path, error)),
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test may panic")]

    use super::*;

    #[test]
    fn the_second_is_refused_until_the_first_is_done() {
        let folder = tempfile::tempdir().unwrap();
        let first = RunLock::take(folder.path()).unwrap();
        let message = RunLock::take(folder.path()).unwrap_err().to_string();
        let name = folder.path().display().to_string();
        assert!(message.contains(&name) && message.contains("choose another"), "{message}");
        drop(first);
        let waited = RunLock::wait(folder.path()).unwrap();
        assert!(RunLock::take(folder.path()).is_err());
        drop(waited);
        RunLock::take(folder.path()).unwrap();
    }

    #[test]
    fn files_in_one_folder_are_taken_each_by_itself() {
        let folder = tempfile::tempdir().unwrap();
        let [hall, gate] = ["hall.memory", "gate.memory"].map(|name| folder.path().join(name));
        let first = RunLock::take_file(&hall).unwrap();
        let message = RunLock::take_file(&hall).unwrap_err().to_string();
        assert!(message.contains("hall.memory"), "{message}");
        RunLock::take_file(&gate).unwrap();
        drop(first);
        RunLock::take_file(&hall).unwrap();
    }
}
