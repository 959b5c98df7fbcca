//! Files that are there whole or not at all.

use std::fs::{self, File};
use std::io::Write as _;
use std::path::Path;

use anyhow::{Context, Result};

/// Heads the name of a file that is being written.
const WRITING: &str = ".writing-";
/// The same where the program writes a report.
const WRITING_REPORT: &str = ".report-";

/// Removes what killed processes were writing into a folder. Only for who has the folder to himself; what cannot be removed does no harm.
pub(crate) fn remove_half_written(folder: &Path) {
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let is_folder = entry.file_type().is_ok_and(|kind| kind.is_dir());
        let name = entry.file_name();
        let name = name.to_string_lossy();
        if !is_folder
            && [WRITING, WRITING_REPORT]
                .iter()
                .any(|mark| name.starts_with(mark))
        {
            let _ = fs::remove_file(entry.path());
        }
    }
}

/// Writes a file under a temporary name in its folder, which is made if need be, and renames it.
pub(crate) fn write(path: &Path, bytes: &[u8]) -> Result<()> {
    let folder = path.parent().context("a file needs a folder to lie in")?;
    fs::create_dir_all(folder)
        .and_then(|()| tempfile::Builder::new().prefix(WRITING).tempfile_in(folder))
        .and_then(|mut temporary| temporary.write_all(bytes).map(|()| temporary))
        .and_then(|temporary| temporary.as_file().sync_all().map(|()| temporary))
        .and_then(|temporary| temporary.persist(path).map_err(|error| error.error))
        .with_context(|| format!("{} cannot be written", path.display()))
        .and_then(|file| readable_by_all(&file))
}

/// Undoes the privacy of a temporary file.
pub(crate) fn readable_by_all(file: &File) -> Result<()> {
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt as _;
        file.set_permissions(fs::Permissions::from_mode(0o644))
            .context("the permissions of a new file cannot be set")?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_replaced_as_a_whole_and_nothing_else_is_left() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a/b.json");
        write(&path, b"one").unwrap();
        write(&path, b"two").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"two");
        assert_eq!(fs::read_dir(path.parent().unwrap()).unwrap().count(), 1);
    }

    #[test]
    fn what_was_half_written_is_removed_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let deep = folder.path().join("task");
        fs::create_dir_all(&deep).unwrap();
        for name in [
            ".writing-a1",
            ".report-c3",
            "goals.json",
            "task/.writing-b2",
        ] {
            fs::write(folder.path().join(name), "half").unwrap();
        }
        // what lies deeper belongs to somebody else
        remove_half_written(folder.path());
        assert!(folder.path().join("goals.json").is_file());
        assert!(!folder.path().join(".writing-a1").exists());
        assert!(!folder.path().join(".report-c3").exists());
        assert!(deep.join(".writing-b2").is_file());
    }
}
