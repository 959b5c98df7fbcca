//! The user's cache, which is kept between calls: libtorch and tools, one folder each. Files and folders are whole or
//! absent.

use std::env;
use std::fmt::Write as _;
use std::fs;
use std::io::Read as _;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use sha2::{Digest as _, Sha256};

/// `$XDG_CACHE_HOME/ddl`, or `~/.cache/ddl`.
pub(crate) fn folder() -> Result<PathBuf> {
    let base = env::var_os("XDG_CACHE_HOME")
        .map(PathBuf::from)
        .filter(|path| path.is_absolute())
        .or_else(|| env::home_dir().map(|home| home.join(".cache")))
        .context(
            "no home folder: set XDG_CACHE_HOME, or give a folder for libtorch with `cargo xtask setup --cache`",
        )?;
    Ok(base.join("ddl"))
}

/// Puts a folder into the cache, complete or not at all. `make` receives a temporary folder beside it, and returns the
/// finished folder inside. A damaged folder in its place is removed.
pub(crate) fn fill(
    folder: &Path,
    is_whole: impl Fn(&Path) -> bool,
    make: impl FnOnce(&Path) -> Result<PathBuf>,
) -> Result<()> {
    let cache = folder
        .parent()
        .context("a cache folder cannot be the root of the disk")?;
    fs::create_dir_all(cache).with_context(|| format!("{} cannot be created", cache.display()))?;
    let work = tempfile::Builder::new()
        .prefix(".incoming-")
        .tempdir_in(cache)
        .with_context(|| format!("{} cannot be written to", cache.display()))?;
    let finished = make(work.path())?;
    if folder.exists() && !is_whole(folder) {
        fs::rename(folder, work.path().join("replaced"))
            .with_context(|| format!("the damaged {} cannot be replaced", folder.display()))?;
    }
    match fs::rename(finished, folder) {
        Err(_) if is_whole(folder) => Ok(()), // another process was faster
        outcome => outcome.with_context(|| format!("{} cannot be created", folder.display())),
    }
}

/// Writes a file whole or not at all; its folder is created if necessary.
pub(crate) fn write_file(path: &Path, bytes: &[u8]) -> Result<()> {
    let write = || -> Result<()> {
        let folder = path.parent().context("a file lies in a folder")?;
        fs::create_dir_all(folder)?;
        let mut builder = tempfile::Builder::new();
        // Temporary files are private by default.
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o644));
        let file = builder.prefix(".incoming-").tempfile_in(folder)?;
        fs::write(file.path(), bytes)?;
        file.as_file().sync_all()?;
        file.persist(path)?;
        Ok(())
    };
    write().with_context(|| format!("{} cannot be written", path.display()))
}

/// The SHA-256 of a file, in hexadecimal digits.
pub(crate) fn sha256(path: &Path) -> Result<String> {
    let failed = || format!("{} cannot be read", path.display());
    let mut file = fs::File::open(path).with_context(failed)?;
    let mut hasher = Sha256::new();
    let mut block = vec![0; 1 << 16];
    loop {
        match file.read(&mut block).with_context(failed)? {
            0 => break,
            length => hasher.update(&block[..length]),
        }
    }
    let digits = hasher.finalize().iter().fold(String::new(), |mut text, byte| {
        // Writing to a string cannot fail.
        let _ = write!(text, "{byte:02x}");
        text
    });
    Ok(digits)
}

#[cfg(test)]
mod tests {
    use super::*;
    use anyhow::bail;

    #[test]
    fn a_damaged_folder_is_replaced_by_a_finished_one_and_a_failure_leaves_nothing() {
        let cache = tempfile::tempdir().unwrap();
        let folder = cache.path().join("tool");
        let is_whole = |folder: &Path| folder.join("whole").is_file();
        let make = |file: &'static str| {
            move |work: &Path| {
                write_file(&work.join("finished").join(file), b"")?;
                Ok(work.join("finished"))
            }
        };
        assert!(fill(&folder, is_whole, |_| bail!("no network")).is_err());
        assert_eq!(fs::read_dir(cache.path()).unwrap().count(), 0);
        fill(&folder, is_whole, make("half")).unwrap();
        fill(&folder, is_whole, make("whole")).unwrap();
        assert!(is_whole(&folder) && !folder.join("half").exists());
        fill(&folder, is_whole, make("other")).unwrap();
        assert!(is_whole(&folder) && !folder.join("other").exists());
        assert_eq!(fs::read_dir(cache.path()).unwrap().count(), 1);
    }
}
