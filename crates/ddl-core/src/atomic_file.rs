//! Atomic writing: a file is written under a temporary name and renamed.

use std::fs::File;
use std::io::{Error, ErrorKind, Result, Write as _};
use std::path::Path;

/// Prefix of the names of unfinished files.
const WRITING: &str = ".writing-";

/// Writes a file under a temporary name in its folder and renames it when it is complete.
///
/// # Errors
/// When the file cannot be written; an existing file then stays unchanged.
pub fn write_atomically(path: &Path, bytes: &[u8]) -> Result<()> {
    write_atomically_with(path, |file| file.write_all(bytes))
}

/// As [`write_atomically`], for a content that is written in parts.
///
/// # Errors
/// As [`write_atomically`], and those of `write`.
pub fn write_atomically_with<E: From<Error>>(
    path: &Path,
    write: impl FnOnce(&mut File) -> std::result::Result<(), E>,
) -> std::result::Result<(), E> {
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    if !folder.is_dir() {
        let problem = format!("the folder {} does not exist; create it first", folder.display());
        return Err(Error::new(ErrorKind::NotFound, problem).into());
    }
    let mut builder = tempfile::Builder::new();
    let builder = builder.prefix(WRITING);
    // Temporary files are private by default, but results should have the usual permissions.
    #[cfg(unix)]
    let builder = builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    let mut file = builder.tempfile_in(folder)?;
    // A file that replaces a private one stays private.
    #[cfg(unix)]
    if let Ok(before) = path.metadata() {
        file.as_file().set_permissions(before.permissions())?;
    }
    write(file.as_file_mut())?;
    file.as_file().sync_all()?;
    file.persist(path).map_err(|error| error.error)?;
    Ok(())
}

/// Removes the temporary files that killed processes left in a folder. Call it only when no other process writes
/// there. Files that cannot be removed are ignored.
pub fn remove_temporary_files(folder: &Path) {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    for entry in entries.filter(|entry| entry.file_name().to_string_lossy().starts_with(WRITING)) {
        // Removing a folder of that name fails and is ignored.
        let _ = std::fs::remove_file(entry.path());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[cfg(unix)]
    #[test]
    fn a_private_file_stays_private() {
        use std::os::unix::fs::PermissionsExt as _;
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("hall.memory");
        std::fs::write(&path, "old").unwrap();
        std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o600)).unwrap();
        write_atomically(&path, b"new").unwrap();
        assert_eq!(path.metadata().unwrap().permissions().mode() & 0o777, 0o600);
        assert_eq!(std::fs::read(&path).unwrap(), b"new");
    }

    #[test]
    fn only_unfinished_files_are_removed() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        std::fs::create_dir(path("deep")).unwrap();
        for name in [".writing-a1", "whole.json", "deep/.writing-b2"] {
            std::fs::write(path(name), "half").unwrap();
        }
        write_atomically(&path("whole.json"), b"new").unwrap();
        remove_temporary_files(folder.path());
        assert!(!path(".writing-a1").exists());
        assert_eq!(std::fs::read(path("whole.json")).unwrap(), b"new");
        // Files in sub-folders may belong to another process.
        assert!(path("deep/.writing-b2").is_file());
    }
}
