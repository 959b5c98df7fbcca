//! The file in which the memory of a place is kept from one watch to the next.

use crate::error::DdlError;
use crate::forecast::watched_place::WatchedPlace;
use crate::run::lock::RunLock;
use ddl_memory::SceneMemory;
use std::fs::File;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// The file of a scene memory: read when a watch begins, written as frames come and at the end, by one process at a time.
///
/// A file is never written over by a memory that is, or may be, of another place.
#[derive(Debug)]
pub struct MemoryFile {
    /// As it was named.
    path: PathBuf,
    /// Where it lies.
    file: PathBuf,
    written: Instant,
    _lock: RunLock,
}

impl MemoryFile {
    /// From one writing to the next, as long as frames come.
    pub const PAUSE: Duration = Duration::from_mins(1);

    /// Takes the file for this process, and reads the memory in it, if there is one. A link is followed.
    ///
    /// # Errors
    /// When it could not be written later, another process writes it, or it holds no whole memory.
    pub fn open(path: &Path) -> Result<(Self, Option<SceneMemory>), DdlError> {
        let file = resolved(path);
        ensure_writable(&file).map_err(|error| {
            let problem = format!("cannot write this file: {error}");
            DdlError::io(path, std::io::Error::new(error.kind(), problem))
        })?;
        let lock = RunLock::take_file(&file)?;
        let read = file.exists().then(|| SceneMemory::read(path));
        let memory = read.transpose()?;
        let file = Self {
            path: path.to_owned(),
            file,
            written: Instant::now(),
            _lock: lock,
        };
        Ok((file, memory))
    }

    /// The file as it was named.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Whether [`PAUSE`](Self::PAUSE) has passed since it was last written, or tried to be.
    pub fn is_due(&self) -> bool {
        self.written.elapsed() >= Self::PAUSE
    }

    /// Writes the memory, unless it is, or may be, of another place than that in the file, or has seen nothing.
    ///
    /// # Errors
    /// When the file cannot be written; an earlier one is then as it was.
    pub fn write(&mut self, place: &WatchedPlace) -> Result<(), DdlError> {
        self.written = Instant::now();
        let decided = place.refused().is_none() && place.on_trial().is_none();
        // A file without a frame would only fix the frame rate of the next watch.
        if decided && place.memory().last_frame().is_some() {
            place.memory().write(&self.file)?;
        }
        Ok(())
    }

    /// Writes the memory at the end of a watch, whose [trial](WatchedPlace::end_trial) has ended; why the file stays as it was, if it does.
    ///
    /// # Errors
    /// As [`write`](Self::write).
    pub fn end(&mut self, place: &WatchedPlace) -> Result<Option<String>, DdlError> {
        self.write(place)?;
        let path = self.path.display();
        if let Some(other) = place.refused() {
            return Ok(Some(format!(
                "{path}: {other}; the file stays as it is, and what is seen now is not kept in it: give another file for this place"
            )));
        }
        Ok(place.on_trial().map(|tried| {
            format!(
                "{path}: {tried} pedestrians were seen for 8 steps, too few to tell whether the memory is of this place; the file stays as it is"
            )
        }))
    }
}

/// The file itself, wherever a link leads and whatever becomes the folder that the process works in; also where there is no file yet.
fn resolved(path: &Path) -> PathBuf {
    if let Ok(path) = path.canonicalize() {
        return path;
    }
    let path = std::fs::read_link(path).map_or_else(
        |_| path.to_owned(),
        |target| path.parent().unwrap_or(Path::new("")).join(target),
    );
    let folder = path
        .parent()
        .filter(|folder| !folder.as_os_str().is_empty());
    let folder = folder.unwrap_or(Path::new(".")).canonicalize();
    match (folder, path.file_name()) {
        (Ok(folder), Some(name)) => folder.join(name),
        _ => path,
    }
}

/// Whether a file can be written and replaced there; nothing of it changes.
fn ensure_writable(path: &Path) -> std::io::Result<()> {
    if path.exists() {
        // To open a pipe would wait for its reader.
        if !path.is_file() {
            return Err(std::io::Error::other("it is no file"));
        }
        File::options().write(true).open(path)?;
    }
    let folder = path
        .parent()
        .filter(|folder| !folder.as_os_str().is_empty());
    tempfile::tempfile_in(folder.unwrap_or(Path::new(".")))?;
    Ok(())
}
