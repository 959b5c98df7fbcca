//! The lock that lets one process at a time work in a run.

use crate::error::DdlError;
use ddl_core::FileLock;
use std::io::ErrorKind;
use std::path::Path;

/// Name of the locked file.
const FILE: &str = ".lock";

/// The right to write into the directory of a run, released when dropped.
#[derive(Debug)]
pub struct RunLock(#[expect(dead_code, reason = "held, never read")] FileLock);

impl RunLock {
    /// Locks the directory without waiting.
    ///
    /// # Errors
    /// [`DdlError::Run`] when another process holds the lock.
    pub fn take(folder: &Path) -> Result<Self, DdlError> {
        let lock = folder.join(FILE);
        let taken = "another process works in this directory; wait until it is done, or choose another directory";
        FileLock::take(&lock).map(Self).map_err(|error| match error.kind() {
            ErrorKind::WouldBlock => DdlError::run(folder, taken),
            _ => DdlError::io(lock, error),
        })
    }

    /// Waits for the lock of the directory, to write results of finished work.
    pub(crate) fn wait(folder: &Path) -> Result<Self, DdlError> {
        let lock = folder.join(FILE);
        FileLock::wait(&lock).map(Self).map_err(|error| DdlError::io(lock, error))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_second_is_refused_by_name() {
        let folder = tempfile::tempdir().unwrap();
        let _first = RunLock::take(folder.path()).unwrap();
        let message = RunLock::take(folder.path()).unwrap_err().to_string();
        let name = folder.path().display().to_string();
        assert!(message.contains(&name) && message.contains("choose another"), "{message}");
    }
}
