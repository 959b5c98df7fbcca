//! Atomic writing: a file is written under a temporary name and renamed.

use std::io::{Error, ErrorKind, Result, Write as _};
use std::path::Path;

/// How the names of files begin that are being written.
pub const WRITING: &str = ".writing-";

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
