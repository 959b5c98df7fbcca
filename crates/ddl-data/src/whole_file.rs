//! Atomic writing: a file is written under a temporary name and renamed.

use std::io::{Error, ErrorKind, Result, Write as _};
use std::path::Path;

/// How the names of files begin that are being written.
const WRITING: &str = ".writing-";

/// Writes a file under a temporary name in its folder and renames it when it is whole.
///
/// # Errors
/// When the file cannot be written; an earlier one is then left as it was.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<()> {
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    if !folder.is_dir() {
        let problem = format!("there is no folder {}", folder.display());
        return Err(Error::new(ErrorKind::NotFound, problem));
    }
    let mut builder = tempfile::Builder::new();
    let builder = builder.prefix(WRITING);
    // Temporary files are private by default; results are as readable as the user's other files.
    #[cfg(unix)]
    let builder = builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    let mut file = builder.tempfile_in(folder)?;
    file.write_all(bytes)?;
    file.as_file().sync_all()?;
    file.persist(path).map_err(|error| error.error)?;
    Ok(())
}

/// Removes what killed processes were writing into a folder. Only for who has the folder to himself; what cannot be removed does no harm.
pub fn remove_half_written(folder: &Path) {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    for entry in entries.filter(|entry| entry.file_name().to_string_lossy().starts_with(WRITING)) {
        // of a folder of that name this is an error
        let _ = std::fs::remove_file(entry.path());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_half_written_is_removed_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        std::fs::create_dir(at("deep")).unwrap();
        for name in [".writing-a1", "whole.json", "deep/.writing-b2"] {
            std::fs::write(at(name), "half").unwrap();
        }
        write_whole(&at("whole.json"), b"new").unwrap();
        remove_half_written(folder.path());
        assert!(!at(".writing-a1").exists());
        assert_eq!(std::fs::read(at("whole.json")).unwrap(), b"new");
        // what lies deeper belongs to somebody else
        assert!(at("deep/.writing-b2").is_file());
    }
}
