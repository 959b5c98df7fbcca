//! The file of a place's memory: read when a stream begins, and written while frames arrive.

use crate::interrupt::Interrupt;
use crate::telling::{tell, words};
use anyhow::Context as _;
use ddl::data::{PedestrianId, Position, Window};
use ddl::memory::SceneMemory;
use ddl::{Ddl, DdlError, MemoryFile, WatchedPlace};
use std::path::Path;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// The memory of `--memory`, if given. Ctrl-C also writes it, from a separate thread.
pub(super) struct KeptMemory(Option<Arc<Mutex<Kept>>>);

type SeenFrame = (i64, Vec<(PedestrianId, Position)>);

struct Kept {
    file: MemoryFile,
    /// The memory in the file, until the number of frames in a step is known.
    read: Option<SceneMemory>,
    place: Option<WatchedPlace>,
    /// The frames until then.
    early: Vec<SeenFrame>,
    is_refusal_told: bool,
}

impl KeptMemory {
    /// Reads the file if it exists, and checks that it can be written.
    pub(super) fn open(path: Option<&Path>, model: &Ddl) -> anyhow::Result<Self> {
        let Some(path) = path else {
            return Ok(Self(None));
        };
        model.goal_model().remembered_at_once()?;
        let kept = Arc::new(Mutex::new(Kept::open(path)?));
        let of_handler = Arc::clone(&kept);
        Interrupt::catch_until(2, move |_| {
            if let Err(error) = lock(&of_handler).end() {
                tell(format_args!("error: {}", words(&error)));
            }
            std::process::exit(130);
        })?;
        Ok(Self(Some(kept)))
    }

    fn kept(&self) -> Option<MutexGuard<'_, Kept>> {
        self.0.as_deref().map(lock)
    }

    /// Starts to remember, once the number of frames in a step is known.
    pub(super) fn begin(&self, model: &Ddl, frame_step: Option<i64>) -> anyhow::Result<()> {
        match (self.kept(), frame_step) {
            (Some(mut kept), Some(step)) => kept.begin(model, step),
            _ => Ok(()),
        }
    }

    /// Adds the memory before this frame to the window that ends in it, then remembers the frame.
    pub(super) fn watch(
        &self,
        frame: &SeenFrame,
        window: Option<Window>,
    ) -> anyhow::Result<Option<Window>> {
        match self.kept() {
            Some(mut kept) => kept.watch(frame, window),
            None => Ok(window),
        }
    }

    /// Writes the file if a minute has passed. If that fails, forecasts continue.
    pub(super) fn write_when_due(&self) {
        let Some(mut kept) = self.kept().filter(|kept| kept.file.is_due()) else {
            return;
        };
        if let Err(error) = kept.write() {
            tell(format_args!(
                "warning: {}; the next attempt follows",
                words(&error)
            ));
        }
    }

    /// Writes the file at the end of the stream.
    pub(super) fn end(&self) -> anyhow::Result<()> {
        self.kept().map_or(Ok(()), |mut kept| kept.end())
    }
}

/// Also after a panic of the other thread: a memory is consistent after every call.
fn lock(kept: &Mutex<Kept>) -> MutexGuard<'_, Kept> {
    kept.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Kept {
    fn open(path: &Path) -> anyhow::Result<Self> {
        let (file, read) = MemoryFile::open(path)?;
        Ok(Self {
            file,
            read,
            place: None,
            early: Vec::new(),
            is_refusal_told: false,
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
                .with_context(|| self.file.path().display().to_string());
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
        if let (Some(other), false) = (place.refused(), self.is_refusal_told) {
            tell(format_args!(
                "warning: {}: {other}; the file is unchanged, and this watch is not saved in it: give another --memory \
                 FILE for this place",
                self.file.path().display()
            ));
            self.is_refusal_told = true;
        }
        Ok(window)
    }

    fn write(&mut self) -> anyhow::Result<()> {
        match &self.place {
            Some(place) => Ok(self.file.write(place)?),
            None => Ok(()),
        }
    }

    fn end(&mut self) -> anyhow::Result<()> {
        let Some(place) = &mut self.place else {
            return Ok(());
        };
        place.end_trial();
        let why = self.file.end(place)?;
        match why.filter(|_| !self.is_refusal_told) {
            Some(why) => {
                self.is_refusal_told = true;
                tell(format_args!("warning: {why}"));
            }
            None if place.refused().is_none() && place.memory().last_frame().is_some() => {
                tell(format_args!(
                    "note: {} remembers {} stretches, 8 s of one pedestrian each",
                    self.file.path().display(),
                    place.memory().stretches()
                ));
            }
            None => {}
        }
        Ok(())
    }
}
