//! The memory of a place in its file: read when a stream begins, and written as frames come.

use crate::interrupt::Interrupt;
use crate::telling::{tell, words};
use anyhow::Context as _;
use ddl::data::{PedestrianId, Position, Window};
use ddl::memory::SceneMemory;
use ddl::{Ddl, DdlError, RunLock, WatchedPlace};
use std::fs::File;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// From one writing to the next.
const PAUSE: Duration = Duration::from_mins(1);

/// The memory that `--memory` names, or nothing. Ctrl-C writes it too, from a thread of its own.
pub(super) struct KeptMemory(Option<Arc<Mutex<MemoryFile>>>);

type SeenFrame = (i64, Vec<(PedestrianId, Position)>);

struct MemoryFile {
    path: PathBuf,
    /// What was in the file, until it is known how many frames make a step.
    read: Option<SceneMemory>,
    place: Option<WatchedPlace>,
    /// The frames seen until then.
    early: Vec<SeenFrame>,
    written: Instant,
    is_refusal_told: bool,
    _lock: RunLock,
}

impl KeptMemory {
    /// Reads the file, if there is one. What would keep it from being written is found here.
    pub(super) fn open(path: Option<&Path>, model: &Ddl) -> anyhow::Result<Self> {
        let Some(path) = path else {
            return Ok(Self(None));
        };
        model.goal_model().remembered_at_once()?;
        let file = Arc::new(Mutex::new(MemoryFile::open(path)?));
        let of_handler = Arc::clone(&file);
        Interrupt::catch_until(2, move |_| {
            if let Err(error) = lock(&of_handler).end() {
                tell(format_args!("error: {}", words(&error)));
            }
            std::process::exit(130);
        })?;
        Ok(Self(Some(file)))
    }

    fn file(&self) -> Option<MutexGuard<'_, MemoryFile>> {
        self.0.as_deref().map(lock)
    }

    /// Begins to remember, as soon as it is known how many frames make a step.
    pub(super) fn begin(&self, model: &Ddl, frame_step: Option<i64>) -> anyhow::Result<()> {
        match (self.file(), frame_step) {
            (Some(mut file), Some(step)) => file.begin(model, step),
            _ => Ok(()),
        }
    }

    /// The window with what was remembered before this frame, in which it ends; then the frame is remembered.
    pub(super) fn watch(
        &self,
        frame: &SeenFrame,
        window: Option<Window>,
    ) -> anyhow::Result<Option<Window>> {
        match self.file() {
            Some(mut file) => file.watch(frame, window),
            None => Ok(window),
        }
    }

    /// Writes the file where a minute has passed. Where that fails, forecasts go on.
    pub(super) fn write_when_due(&self) {
        let Some(mut file) = self.file().filter(|file| file.written.elapsed() >= PAUSE) else {
            return;
        };
        if let Err(error) = file.write() {
            tell(format_args!(
                "warning: {}; it is tried again",
                words(&error)
            ));
        }
    }

    /// Writes the file at the end of the stream.
    pub(super) fn end(&self) -> anyhow::Result<()> {
        self.file().map_or(Ok(()), |mut file| file.end())
    }
}

/// After a panic of the other thread too: a memory is whole after every call.
fn lock(file: &Mutex<MemoryFile>) -> MutexGuard<'_, MemoryFile> {
    file.lock().unwrap_or_else(PoisonError::into_inner)
}

impl MemoryFile {
    fn open(path: &Path) -> anyhow::Result<Self> {
        ensure_writable(path).with_context(|| format!("cannot write {}", path.display()))?;
        let lock = RunLock::take_file(path)?;
        let read = path.exists().then(|| SceneMemory::read(path));
        Ok(Self {
            path: path.to_owned(),
            read: read.transpose()?,
            place: None,
            early: Vec::new(),
            written: Instant::now(),
            is_refusal_told: false,
            _lock: lock,
        })
    }

    fn begin(&mut self, model: &Ddl, camera: i64) -> anyhow::Result<()> {
        if self.place.is_some() {
            return Ok(());
        }
        let memory = match self.read.take() {
            Some(memory) => memory,
            None => SceneMemory::new(camera, SceneMemory::DEFAULT_CAPACITY)?,
        };
        let its = memory.frame_step();
        if its != camera {
            let memory = its;
            return Err(DdlError::MemoryFrameStep { camera, memory })
                .with_context(|| self.path.display().to_string());
        }
        let place = self.place.insert(WatchedPlace::new(model, memory)?);
        for (number, people) in self.early.drain(..) {
            place.observe(number, people, None)?;
        }
        Ok(())
    }

    fn watch(
        &mut self,
        (number, people): &SeenFrame,
        window: Option<Window>,
    ) -> anyhow::Result<Option<Window>> {
        let people = people.iter().copied();
        let Some(place) = &mut self.place else {
            self.early.push((*number, people.collect()));
            return Ok(window);
        };
        let window = window.map(|window| place.recalling(window));
        place.observe(*number, people, window.as_ref())?;
        self.tell_refusal();
        Ok(window)
    }

    fn tell_refusal(&mut self) {
        let refused = self.place.as_ref().and_then(WatchedPlace::refused);
        if let (Some(other), false) = (refused, self.is_refusal_told) {
            tell(format_args!(
                "warning: {}: {other}; the file stays as it is, and what is seen now is not kept in it: give another --memory FILE for this place",
                self.path.display()
            ));
            self.is_refusal_told = true;
        }
    }

    /// Writes the file, but not over a memory that is, or may be, of another place.
    fn write(&mut self) -> anyhow::Result<()> {
        self.written = Instant::now();
        let place = self.place.as_ref();
        let kept = place.filter(|place| {
            let decided = place.refused().is_none() && place.on_trial().is_none();
            // A file without a frame would only fix the frame rate of the next stream.
            decided && place.memory().last_frame().is_some()
        });
        kept.map_or(Ok(()), |place| Ok(place.memory().write(&self.path)?))
    }

    fn end(&mut self) -> anyhow::Result<()> {
        if let Some(place) = &mut self.place {
            place.end_trial();
            if let Some(tried) = place.on_trial() {
                tell(format_args!(
                    "warning: {}: {tried} pedestrians were seen for 8 steps, too few to tell whether the memory is of this place; the file \
                     stays as it is",
                    self.path.display()
                ));
            }
        }
        self.tell_refusal();
        self.write()
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
