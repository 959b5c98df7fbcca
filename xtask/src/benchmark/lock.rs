//! One benchmark works in a folder at a time.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::path::Path;

use anyhow::{Context, Result, bail};

/// The file that is locked, in the folder of a benchmark. It stays, empty.
const FILE: &str = ".lock";

/// The right to work in the folder of a benchmark, given back when dropped.
///
/// The system holds the lock for the process: it does not outlive it, however that ends.
#[derive(Debug)]
pub(crate) struct Lock(#[expect(dead_code, reason = "held, never read")] File);

impl Lock {
    /// Takes the folder, which is made if need be, at once or not at all.
    ///
    /// # Errors
    /// When another process has it, or nothing can be written there.
    pub(crate) fn take(folder: &Path) -> Result<Self> {
        let path = folder.join(FILE);
        let file = fs::create_dir_all(folder)
            .and_then(|()| {
                OpenOptions::new()
                    .create(true)
                    .truncate(false)
                    .write(true)
                    .open(&path)
            })
            .with_context(|| format!("{} cannot be written", path.display()))?;
        match file.try_lock() {
            // A file system without locks protects nobody, and is no reason to stop.
            Ok(()) | Err(TryLockError::Error(_)) => Ok(Self(file)),
            Err(TryLockError::WouldBlock) => bail!(
                "another benchmark is at work in {}: wait until it is done, or choose another --out",
                folder.display()
            ),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_second_is_refused_until_the_first_is_done() {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("runs/new");
        let first = Lock::take(&out).unwrap();
        let message = Lock::take(&out).unwrap_err().to_string();
        assert!(message.contains(&out.display().to_string()), "{message}");
        assert!(message.contains("choose another --out"), "{message}");
        drop(first);
        Lock::take(&out).unwrap();
    }
}
