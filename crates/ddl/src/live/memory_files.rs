//! Where the memories of a session are kept.

use crate::error::DdlError;
use ddl_data::SceneName;
use ddl_memory::{MemoryError, MemoryFile, SceneMemory};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// Where a session keeps what its places teach.
#[derive(Debug, Default)]
pub enum SessionMemory {
    /// Nowhere: nothing is remembered.
    #[default]
    None,
    /// In this process.
    Kept,
    /// In a file of one place, which one process at a time writes: every minute, and at the end. The memory in it is
    /// read at the start.
    #[non_exhaustive]
    File {
        /// The path as given.
        path: PathBuf,
        /// `None` once a scene has it.
        open: Option<Box<OpenMemory>>,
    },
    /// In a folder, with a file for each scene.
    Folder(PathBuf),
}

/// An open file, and the memory that was in it.
#[derive(Debug)]
pub struct OpenMemory {
    pub(crate) file: Option<MemoryFile>,
    pub(crate) read: Option<SceneMemory>,
}

impl SessionMemory {
    /// A memory in a file, which is created if it is missing, or in a folder that is there.
    ///
    /// # Errors
    /// When the file is not writable, another process writes it, or it holds no complete memory.
    pub fn at(path: &Path) -> Result<Self, DdlError> {
        if path.is_dir() { Ok(Self::Folder(path.to_owned())) } else { Self::in_file(path) }
    }

    /// As [`at`](Self::at), for one place: a folder is refused.
    ///
    /// # Errors
    /// As [`at`](Self::at).
    pub fn in_file(path: &Path) -> Result<Self, DdlError> {
        Ok(Self::File { path: path.to_owned(), open: Some(Box::new(OpenMemory::open(path)?)) })
    }

    /// Refuses frames without scene names for a folder, and frames of named scenes for a file.
    ///
    /// # Errors
    /// [`DdlError::MemoryOfScenes`].
    pub fn ensure_fits(&self, scene: Option<&SceneName>) -> Result<(), DdlError> {
        match (self, scene) {
            (Self::Folder(path), None) => Err(DdlError::MemoryOfScenes { path: path.clone(), is_folder: true }),
            (Self::File { path, .. }, Some(_)) => {
                Err(DdlError::MemoryOfScenes { path: path.clone(), is_folder: false })
            }
            _ => Ok(()),
        }
    }

    pub(crate) fn is_of_one_place(&self) -> bool {
        matches!(self, Self::Kept | Self::File { .. })
    }

    /// The memory of a scene that begins.
    pub(crate) fn of_scene(&mut self, scene: Option<&SceneName>) -> Result<Option<OpenMemory>, DdlError> {
        self.ensure_fits(scene)?;
        Ok(match (self, scene) {
            (Self::Kept, _) => Some(OpenMemory { file: None, read: None }),
            (Self::File { open, .. }, _) => open.take().map(|open| *open),
            (Self::Folder(folder), Some(scene)) => Some(OpenMemory::open(&folder.join(file_stem(scene) + ".memory"))?),
            _ => None,
        })
    }
}

impl OpenMemory {
    fn open(path: &Path) -> Result<Self, MemoryError> {
        let (file, read) = MemoryFile::open(path)?;
        Ok(Self { file: Some(file), read })
    }
}

/// The name of a scene in file names: characters with a meaning in paths are written as `%` and two hexadecimal digits.
pub fn file_stem(scene: &SceneName) -> String {
    let mut name = String::new();
    for byte in scene.as_str().bytes() {
        if byte.is_ascii_alphanumeric() || matches!(byte, b'-' | b'_') {
            name.push(byte.into());
        } else {
            let _ = write!(name, "%{byte:02X}");
        }
    }
    name
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_scene_leads_out_of_the_folder() {
        for (scene, file) in [
            ("hall", "hall.memory"),
            ("../hall", "%2E%2E%2Fhall.memory"),
            ("a b", "a%20b.memory"),
            ("C:\\é", "C%3A%5C%C3%A9.memory"),
        ] {
            assert_eq!(file_stem(&SceneName::new(scene).unwrap()) + ".memory", file);
        }
    }
}
