//! One scene that is observed frame by frame: its tracks, and the memory of the place.

use crate::error::DdlError;
use crate::live::memory_files::OpenMemory;
use crate::model::ddl::Ddl;
use crate::note::{MisfitNote, Note};
use ddl_core::{PedestrianId, PedestrianNames, Position, Window};
use ddl_data::{LiveTracks, MisfitTreatment, SceneName};
use ddl_memory::{MemoryError, MemoryFile, PlaceMemory, SceneMemory};
use std::time::Instant;

/// What a [`Session`](crate::Session) keeps of each scene.
#[derive(Debug)]
pub(crate) struct WatchedScene {
    pub(crate) tracks: LiveTracks,
    pub(crate) place: Option<PlaceMemory>,
    file: Option<MemoryFile>,
    is_refusal_told: bool,
    /// When its last frame came; `None` until then, and for a place without a name, which is never forgotten. A
    /// browser has no such clock.
    pub(crate) heard: Option<Instant>,
}

impl WatchedScene {
    pub(crate) fn new(tracks: LiveTracks) -> Self {
        Self { tracks, place: None, file: None, is_refusal_told: false, heard: None }
    }

    /// Uses this memory of the place from now on.
    ///
    /// # Errors
    /// When the model has no memory branch, or the memory has another number of raw frames per step.
    pub(crate) fn remembering(self, model: &Ddl, OpenMemory { file, read }: OpenMemory) -> Result<Self, DdlError> {
        let count = model.goal_model().recalled_per_pedestrian()?;
        let camera = self.tracks.clock().frame_step();
        let memory = match read {
            Some(memory) => memory,
            None => SceneMemory::new(camera, SceneMemory::DEFAULT_CAPACITY)?,
        };
        if memory.frame_step() != camera {
            let error = MemoryError::OtherRate { camera, memory: memory.frame_step() };
            return Err(match file {
                Some(file) => error.in_file(file.path()),
                None => error,
            }
            .into());
        }
        Ok(Self { place: Some(PlaceMemory::new(memory, count)), file, ..self })
    }

    /// Adds a frame. If a pedestrian can be forecast, returns the window with the recalled tracks, and the result of
    /// the given function for it. After an error nothing has changed.
    pub(crate) fn push<T>(
        &mut self,
        frame: i64,
        pedestrians: Vec<(PedestrianId, Position)>,
        names: &PedestrianNames,
        answer: impl FnOnce(&Window) -> Result<T, ddl_core::ForecastError>,
    ) -> Result<Option<(Window, T)>, DdlError> {
        let mut tracks = self.tracks.after(frame, pedestrians.iter().copied())?;
        tracks.name(names);
        let answered = match tracks.window() {
            None => None,
            Some(window) => {
                let window = match &self.place {
                    Some(place) => place.recalling(window),
                    None => window,
                };
                let answer = answer(&window)?;
                Some((window, answer))
            }
        };
        if let Some(place) = &mut self.place {
            // Rows that were left out are not stored. A track that begins anew is not joined to the one before. If only
            // the next row shows that a row is wrong, that row is stored already.
            let rows = pedestrians.into_iter().filter(|(id, _)| !tracks.has_left_out(*id));
            let begun = tracks.misfits().iter().filter(|misfit| misfit.treatment != MisfitTreatment::LeftOut);
            let begun: Vec<PedestrianId> = begun.map(|misfit| misfit.pedestrian).collect();
            let window = answered.as_ref().map(|(window, _)| window);
            place.observe(tracks.last_frame().unwrap_or(frame), rows, &begun, window)?;
        }
        self.tracks = tracks;
        Ok(answered)
    }

    /// What there is to say of the last frame, after which the memory is written if it is due.
    pub(crate) fn notes(&mut self, scene: Option<&SceneName>) -> Vec<Note> {
        let tracks = &self.tracks;
        let misfits = MisfitNote::all(tracks.misfits(), tracks.names(), tracks.clock());
        let mut notes = Vec::new();
        if !misfits.is_empty() {
            notes.push(Note::Misfits { scene: scene.cloned(), misfits });
        }
        let (Some(place), Some(file)) = (&self.place, &mut self.file) else {
            return notes;
        };
        if let Some(refusal) = place.refused()
            && !std::mem::replace(&mut self.is_refusal_told, true)
        {
            notes.push(Note::MemoryRefused { path: file.path().to_owned(), refusal });
        }
        notes.extend(self.write_due());
        notes
    }

    /// Writes the memory, if a minute has passed.
    pub(crate) fn write_due(&mut self) -> Option<Note> {
        let (place, file) = (self.place.as_ref()?, self.file.as_mut().filter(|file| file.is_due())?);
        Some(Note::MemoryUnwritten(DdlError::from(file.write(place).err()?).into()))
    }

    /// The tracker restarts: any frame may come next.
    pub(crate) fn clear(&mut self) {
        self.tracks.clear();
        if let Some(place) = &mut self.place {
            place.end_tracks();
        }
    }

    /// Writes the memory and closes its file, which stays open if that fails.
    pub(crate) fn close(&mut self) -> Option<Note> {
        let (file, place) = (self.file.as_mut()?, self.place.as_ref()?);
        let (path, segments) = (file.path().to_owned(), place.memory().segments());
        let is_empty = place.memory().summary().frames == 0;
        let ended = file.end(place.clone());
        if let Err(error) = ended {
            return Some(Note::MemoryFailed(DdlError::from(error).into()));
        }
        self.file = None;
        match ended {
            Ok(Some(unsaved)) => Some(Note::MemoryUnsaved { unsaved, is_refusal_told: self.is_refusal_told }),
            _ if is_empty => None,
            _ => Some(Note::MemoryKept { path, segments }),
        }
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::run::builtin_model::BuiltinModel;
    use ddl_core::OBSERVED;
    use ddl_data::Clock;
    use ddl_network::DeviceChoice;

    pub(crate) fn model() -> Ddl {
        Ddl::builtin(BuiltinModel::default(), DeviceChoice::Cpu).unwrap()
    }

    /// A camera of 7 frames a second: 2.8 frames, or 14 ticks, make a step.
    #[test]
    fn the_memory_holds_the_rows_of_the_tracks() {
        let model = model();
        let clock = Clock::with_frame_time(1.0 / 7.0).unwrap();
        let remembering = |read| {
            WatchedScene::new(LiveTracks::with_clock(clock)).remembering(&model, OpenMemory { file: None, read })
        };
        let other = remembering(Some(SceneMemory::new(3, 9).unwrap()));
        assert!(matches!(other, Err(DdlError::Memory(MemoryError::OtherRate { camera: 14, memory: 3 }))));
        let mut watch = remembering(None).unwrap();
        // The first pedestrian has an impossible row; the second walks on 2 m aside, as if it were another one.
        let rows = |frame: i64| {
            let along = 0.17 * frame as f64;
            let [wrong, aside] = [frame == 20, frame >= 62].map(|holds| if holds { 2.0 } else { 0.0 });
            vec![(PedestrianId(1), [along, 30.0 * wrong]), (PedestrianId(2), [along, 2.0 + aside])]
        };
        let memory_of = |watch: &WatchedScene| watch.place.as_ref().unwrap().memory().clone();
        let push = |watch: &mut WatchedScene, frame| {
            watch.push(frame, rows(frame), &PedestrianNames::default(), |_| Ok(())).unwrap()
        };
        for frame in 0..125 {
            push(&mut watch, frame);
        }
        let summary = memory_of(&watch).summary();
        assert_eq!((summary.frames, summary.pedestrians, summary.tracks), (125, 2, 2));
        assert!((summary.seconds - 124.0 / 7.0).abs() < 1e-9, "{summary:?}");
        let [_, high] = summary.extent.unwrap();
        assert!((high[1] - 4.0).abs() < 1e-9, "the impossible row is not remembered");
        let tracks: Vec<Vec<Position>> = memory_of(&watch).tracks().collect();
        assert!(tracks[0].iter().all(|[_, y]| y.abs() < 1e-9), "{tracks:?}");
        let on = |lane: f64| tracks[1].iter().filter(|[_, y]| (y - lane).abs() < 1e-9).count();
        assert!(on(2.0) > 8 && on(4.0) > 8 && on(2.0) + on(4.0) == tracks[1].len(), "{tracks:?}");
        // An error changes nothing. What a window recalls was observed before its last frame.
        let before = (watch.tracks.clone(), memory_of(&watch));
        let failure = ddl_core::ForecastError::model("none", DdlError::Interrupted);
        let failed: Result<Option<(Window, ())>, _> =
            watch.push(125, rows(125), &PedestrianNames::default(), |_| Err(failure));
        assert!(failed.is_err() && (watch.tracks.clone(), memory_of(&watch)) == before);
        let (window, ()) = push(&mut watch, 125).unwrap();
        let count = model.goal_model().recalled_per_pedestrian().unwrap();
        for (i, &id) in window.pedestrians().iter().enumerate() {
            let observed: &[Position; OBSERVED] = window.observed(i).first_chunk().unwrap();
            assert_eq!(window.remembered(i), before.1.recall(observed, Some(id), count));
            assert_eq!(window.remembered(i).len(), 1);
        }
        // A restarted tracker counts from 0, and its pedestrians are others.
        watch.clear();
        push(&mut watch, 0);
        assert_eq!(memory_of(&watch).summary().pedestrians, 4);
    }
}
