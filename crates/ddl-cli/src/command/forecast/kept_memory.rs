//! The files of scene memories: read when a scene begins, and written while frames arrive.

use crate::telling::{tell, words};
use anyhow::{Context as _, bail};
use ddl::data::SceneName;
use ddl::memory::SceneMemory;
use ddl::{Ddl, DdlError, LiveScenes, MemoryFile, PlaceMemory};
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// The memory that `--memory` names: a file of one place, or a folder with a file for each scene.
pub(super) struct KeptMemory {
    path: PathBuf,
    is_folder: bool,
    /// `None` for a scene whose file cannot be used.
    memories: BTreeMap<Option<SceneName>, Option<OpenMemory>>,
}

struct OpenMemory {
    file: MemoryFile,
    /// The memory in the file, until the frame step is known.
    read: Option<SceneMemory>,
    is_refusal_told: bool,
}

impl KeptMemory {
    /// Reads the file, if there is one, and checks that it can be written.
    pub(super) fn open(path: &Path, model: &Ddl) -> anyhow::Result<Self> {
        model.goal_model().recalled_per_pedestrian()?;
        let is_folder = path.is_dir();
        let mut memories = BTreeMap::new();
        if !is_folder {
            memories.insert(None, Some(OpenMemory::open(path)?));
        }
        Ok(Self { path: path.to_owned(), is_folder, memories })
    }

    /// Refuses a stream of one scene with a folder, and one of several with a file.
    pub(super) fn ensure_fits(&self, scene: Option<&SceneName>) -> anyhow::Result<()> {
        let path = self.path.display();
        match (scene, self.is_folder) {
            (None, true) => bail!(
                "--memory {path} is a folder, and the lines name no scenes; name a file, or give the lines a \
                 column scene"
            ),
            (Some(_), false) => bail!(
                "--memory {path} is a file of one place, and the lines name scenes; name a folder that is there, \
                 for a file of each scene"
            ),
            _ => Ok(()),
        }
    }

    /// Adds a memory to a new scene, once the frame step is known.
    pub(super) fn begin(
        &mut self,
        scene: Option<&SceneName>,
        scenes: &mut LiveScenes,
        model: &Ddl,
    ) -> anyhow::Result<()> {
        if scenes.place(scene).is_some() {
            return Ok(());
        }
        if let Some(name) = scene {
            if self.memories.contains_key(&scene.cloned()) {
                return Ok(());
            }
            // After a failure, the scene does not try again at every frame.
            self.memories.insert(scene.cloned(), None);
            let memory = OpenMemory::open(&self.path.join(file_stem(name) + ".memory"))?;
            self.memories.insert(scene.cloned(), Some(memory));
        }
        let Some(Some(memory)) = self.memories.get_mut(&scene.cloned()) else {
            return Ok(());
        };
        let begun = memory.begin(scene, scenes, model);
        if begun.is_err() {
            self.memories.insert(scene.cloned(), None);
        }
        begun
    }

    /// Reports that the memory of a scene is of another place, if so.
    pub(super) fn tell_refusal(&mut self, scene: Option<&SceneName>, scenes: &LiveScenes) {
        if let Some(Some(memory)) = self.memories.get_mut(&scene.cloned())
            && let Some(other) = scenes.place(scene).and_then(PlaceMemory::refused)
            && !std::mem::replace(&mut memory.is_refusal_told, true)
        {
            tell(format_args!(
                "warning: {}: {other}; the file stays as it is, and what is seen now is not kept in it: give another \
                 --memory FILE for this place",
                memory.file.path().display()
            ));
        }
    }

    /// Writes the files for which a minute has passed. After an error, forecasts continue.
    pub(super) fn write_when_due(&mut self, scenes: &LiveScenes) {
        for (scene, memory) in &mut self.memories {
            let Some(memory) = memory.as_mut().filter(|memory| memory.file.is_due()) else {
                continue;
            };
            let Some(place) = scenes.place(scene.as_ref()) else {
                continue;
            };
            if let Err(error) = memory.file.write(place) {
                tell(format_args!("warning: {}; it is tried again", words(&error.into())));
            }
        }
    }

    /// Writes the file of a scene that has ended, and closes it.
    pub(super) fn end(&mut self, scene: Option<&SceneName>, scenes: &mut LiveScenes) -> anyhow::Result<()> {
        let Some(Some(mut memory)) = self.memories.remove(&scene.cloned()) else {
            return Ok(());
        };
        let Some(place) = scenes.forget(scene) else {
            return Ok(());
        };
        let (segments, is_empty) = (place.memory().segments(), place.memory().summary().frames == 0);
        match memory.file.end(place)? {
            _ if memory.is_refusal_told => {}
            Some(why) => tell(format_args!("warning: {why}")),
            None if is_empty => {}
            None => tell(format_args!(
                "note: {} remembers {segments} segments, 8 s of one pedestrian each",
                memory.file.path().display()
            )),
        }
        Ok(())
    }

    /// Writes all files at the end of the stream; returns the first error.
    pub(super) fn end_all(&mut self, scenes: &mut LiveScenes) -> anyhow::Result<()> {
        let names: Vec<_> = self.memories.keys().cloned().collect();
        let ends: Vec<_> = names.iter().map(|scene| self.end(scene.as_ref(), scenes)).collect();
        let mut failed = ends.into_iter().filter_map(Result::err);
        let Some(first) = failed.next() else {
            return Ok(());
        };
        for other in failed {
            tell(format_args!("error: {}", words(&other)));
        }
        Err(first)
    }
}

impl OpenMemory {
    fn open(path: &Path) -> anyhow::Result<Self> {
        let (file, read) = MemoryFile::open(path)?;
        Ok(Self { file, read, is_refusal_told: false })
    }

    fn begin(&mut self, scene: Option<&SceneName>, scenes: &mut LiveScenes, model: &Ddl) -> anyhow::Result<()> {
        match scenes.remember(scene, model, self.read.take()) {
            Err(error @ DdlError::MemoryFrameStep { .. }) => {
                Err(error).with_context(|| self.file.path().display().to_string())
            }
            begun => Ok(begun?),
        }
    }
}

/// The name of a scene in file names: characters with a meaning in paths are written as `%` and two hexadecimal digits.
pub(crate) fn file_stem(scene: &SceneName) -> String {
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
