//! The file that stores the memory of a place between sessions.

use std::fs::File;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use ddl_core::FileLock;

use crate::error::MemoryError;
use crate::memory::SceneMemory;
use crate::place::{PlaceMemory, Refusal};

/// The file of a scene memory. It is read at the start of a session and written during and at the end of it, by one
/// process at a time.
///
/// A memory that is, or may be, of another place never overwrites the file.
#[derive(Debug)]
pub struct MemoryFile {
    /// The path as given.
    path: PathBuf,
    /// The path with links resolved.
    file: PathBuf,
    written: Instant,
    _lock: FileLock,
}

/// Why a file is left unchanged at the end of a session.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[expect(missing_docs, reason = "the messages describe the fields")]
pub enum Unsaved {
    #[error(
        "{}: {refusal}; the file is unchanged, and this watch is not saved in it; give another file for this place",
        .path.display()
    )]
    OtherPlace { path: PathBuf, refusal: Refusal },
    #[error(
        "{}: {tried} pedestrians were observed for 8 time steps, too few to tell whether the memory is of this place; \
         the file is unchanged",
        .path.display()
    )]
    TooFew { path: PathBuf, tried: usize },
}

/// The interval between writes while frames arrive.
const PAUSE: Duration = Duration::from_mins(1);

impl MemoryFile {
    /// Opens the file for this process, and reads the memory in it if there is one. Links are followed.
    ///
    /// # Errors
    /// When the file is not writable, another process writes it, or it holds no complete memory.
    pub fn open(path: &Path) -> Result<(Self, Option<SceneMemory>), MemoryError> {
        let file = resolved(path);
        let unwritable = |source| MemoryError::Write { path: path.to_owned(), source };
        ensure_writable(&file).map_err(unwritable)?;
        let lock = FileLock::take_beside(&file).map_err(|error| match error.kind() {
            ErrorKind::WouldBlock => MemoryError::Taken { path: path.to_owned() },
            _ => unwritable(error),
        })?;
        let read = file.exists().then(|| SceneMemory::read(path));
        let memory = read.transpose()?;
        let file = Self { path: path.to_owned(), file, written: Instant::now(), _lock: lock };
        Ok((file, memory))
    }

    /// The path as given.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Whether a minute has passed since the last attempt to write.
    pub fn is_due(&self) -> bool {
        self.written.elapsed() >= PAUSE
    }

    /// Writes the memory, unless it is empty or may be of another place than the file.
    ///
    /// # Errors
    /// When the file cannot be written; an earlier one is unchanged.
    pub fn write(&mut self, place: &PlaceMemory) -> Result<(), MemoryError> {
        self.written = Instant::now();
        let decided = place.refused().is_none() && place.under_test().is_none();
        // Without a frame, the file would only fix the frame rate of the next session.
        if decided && place.memory().summary().frames > 0 {
            place.memory().write(&self.file)?;
        }
        Ok(())
    }

    /// Ends the test of the memory at the end of a session, and writes it. Returns the reason if the file is left
    /// unchanged.
    ///
    /// # Errors
    /// As [`write`](Self::write).
    pub fn end(&mut self, mut place: PlaceMemory) -> Result<Option<Unsaved>, MemoryError> {
        place.finish_test();
        self.write(&place)?;
        let path = || self.path.clone();
        if let Some(refusal) = place.refused() {
            return Ok(Some(Unsaved::OtherPlace { path: path(), refusal }));
        }
        Ok(place.under_test().map(|tried| Unsaved::TooFew { path: path(), tried }))
    }
}

/// The absolute path of the file with links resolved, so that a later change of the working directory does not matter.
/// The file may not exist yet.
fn resolved(path: &Path) -> PathBuf {
    if let Ok(path) = path.canonicalize() {
        return path;
    }
    let path = std::fs::read_link(path)
        .map_or_else(|_| path.to_owned(), |target| path.parent().unwrap_or(Path::new("")).join(target));
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    let folder = folder.unwrap_or(Path::new(".")).canonicalize();
    match (folder, path.file_name()) {
        (Ok(folder), Some(name)) => folder.join(name),
        _ => path,
    }
}

/// Checks that the file can be written and replaced, without changing it.
fn ensure_writable(path: &Path) -> std::io::Result<()> {
    if path.exists() {
        // Opening a pipe would wait for its reader.
        if !path.is_file() {
            return Err(std::io::Error::other("it is not a regular file"));
        }
        File::options().write(true).open(path)?;
    }
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    tempfile::tempfile_in(folder.unwrap_or(Path::new(".")))?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::place::tests::{memory, seen_after};

    #[test]
    fn only_a_memory_of_this_place_is_written() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("gate.memory");
        let (mut file, none) = MemoryFile::open(&path).unwrap();
        let nothing = seen_after(SceneMemory::new(3, 9_000).unwrap(), &[]);
        file.write(&nothing).unwrap();
        assert!(none.is_none() && !path.exists() && !file.is_due());
        let given = memory(55);
        let accepted = seen_after(given.clone(), &[(5, 0.0)]);
        assert_eq!(file.end(accepted.clone()).unwrap(), None);
        assert_eq!(&SceneMemory::read(&path).unwrap(), accepted.memory());
        let before = std::fs::read(&path).unwrap();
        for (strangers, words) in [(30, "give another file"), (2, "2 pedestrians were observed")] {
            let place = seen_after(given.clone(), &[(strangers, 9.0)]);
            file.write(&place).unwrap();
            let told = file.end(place).unwrap().unwrap().to_string();
            assert!(told.contains(words) && told.contains("gate.memory"), "{told}");
            assert_eq!(std::fs::read(&path).unwrap(), before);
        }
        let decided = seen_after(given, &[(1, 9.0), (1, 0.0)]);
        assert_eq!(file.end(decided).unwrap(), None);
        assert_ne!(std::fs::read(&path).unwrap(), before);
    }
}
