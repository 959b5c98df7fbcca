//! Locks that let one process at a time write a file, or into a folder.

use std::fs::{File, OpenOptions, TryLockError};
use std::io::{Error, ErrorKind, Result};
use std::path::Path;

/// The right to write, held through a file of its own. It is released when dropped; the system holds it for the
/// process. `None` inside stands for a read-only place, or for a file system without locks.
///
/// The locked file stays, empty: removing it would break the lock of a waiting process.
#[derive(Debug)]
pub struct FileLock(#[expect(dead_code, reason = "held, never read")] Option<File>);

impl FileLock {
    /// Locks this file without waiting; it is created if missing.
    ///
    /// # Errors
    /// [`ErrorKind::WouldBlock`] when somebody else holds the lock; when the file cannot be created.
    pub fn take(lock: &Path) -> Result<Self> {
        let Some(file) = open(lock)? else {
            return Ok(Self(None));
        };
        match file.try_lock() {
            Ok(()) => Ok(Self(Some(file))),
            Err(TryLockError::WouldBlock) => Err(Error::new(ErrorKind::WouldBlock, "another process holds the lock")),
            Err(TryLockError::Error(_)) => Ok(Self(None)),
        }
    }

    /// Locks a file through one beside it with the suffix `.lock`, without waiting.
    ///
    /// # Errors
    /// As [`take`](Self::take).
    pub fn take_beside(path: &Path) -> Result<Self> {
        let mut lock = path.as_os_str().to_owned();
        lock.push(".lock");
        Self::take(Path::new(&lock))
    }

    /// Waits until this file can be locked.
    ///
    /// # Errors
    /// When the file cannot be created.
    pub fn wait(lock: &Path) -> Result<Self> {
        let file = open(lock)?;
        Ok(Self(file.filter(|file| file.lock().is_ok())))
    }
}

fn open(path: &Path) -> Result<Option<File>> {
    let file = OpenOptions::new().create(true).truncate(false).write(true).open(path);
    match file {
        Ok(file) => Ok(Some(file)),
        // A finished run in a read-only directory is still usable.
        Err(error) if matches!(error.kind(), ErrorKind::PermissionDenied | ErrorKind::ReadOnlyFilesystem) => Ok(None),
        Err(error) => Err(error),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_second_is_refused_until_the_first_is_done() {
        let folder = tempfile::tempdir().unwrap();
        let [hall, gate] = ["hall.memory", "gate.memory"].map(|name| folder.path().join(name));
        let first = FileLock::take_beside(&hall).unwrap();
        assert_eq!(FileLock::take_beside(&hall).unwrap_err().kind(), ErrorKind::WouldBlock);
        FileLock::take_beside(&gate).unwrap();
        drop(first);
        let waited = FileLock::wait(&folder.path().join("hall.memory.lock")).unwrap();
        FileLock::take_beside(&hall).unwrap_err();
        drop(waited);
        FileLock::take_beside(&hall).unwrap();
        FileLock::take_beside(&folder.path().join("no/folder")).unwrap_err();
    }
}
