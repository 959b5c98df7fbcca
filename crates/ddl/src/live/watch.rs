//! One scene that is observed frame by frame: its tracks, and the memory of the place.

use crate::error::DdlError;
use crate::live::place_memory::PlaceMemory;
use crate::model::ddl::Ddl;
use ddl_core::{PedestrianId, Position, Window};
use ddl_data::{LiveTracks, MisfitTreatment};
use ddl_memory::SceneMemory;

/// The state that a [`LiveForecaster`](crate::LiveForecaster) keeps of its scene, and [`LiveScenes`](crate::LiveScenes)
/// of each scene.
#[derive(Debug, Clone)]
pub(crate) struct Watch {
    pub(crate) tracks: LiveTracks,
    pub(crate) place: Option<PlaceMemory>,
}

impl Watch {
    pub(crate) fn new(tracks: LiveTracks) -> Self {
        let place = None;
        Self { tracks, place }
    }

    /// Uses this memory of the place from now on, or an empty one.
    ///
    /// # Errors
    /// When the model has no memory branch, or the memory has another number of raw frames per step.
    pub(crate) fn remember(&mut self, model: &Ddl, memory: Option<SceneMemory>) -> Result<(), DdlError> {
        let camera = self.tracks.clock().frame_step();
        let memory = match memory {
            Some(memory) => memory,
            None => SceneMemory::new(camera, SceneMemory::DEFAULT_CAPACITY)?,
        };
        if memory.frame_step() != camera {
            let memory = memory.frame_step();
            return Err(DdlError::MemoryFrameStep { camera, memory });
        }
        self.place = Some(PlaceMemory::new(model, memory)?);
        Ok(())
    }

    /// Adds a frame. If a pedestrian can be forecast, returns the window with the recalled tracks, and the result of
    /// the given function for it. After an error nothing has changed.
    pub(crate) fn push<T, E>(
        &mut self,
        frame: i64,
        pedestrians: Vec<(PedestrianId, Position)>,
        make: impl FnOnce(&Window) -> Result<T, E>,
    ) -> Result<Option<(Window, T)>, DdlError>
    where
        DdlError: From<E>,
    {
        let tracks = self.tracks.after(frame, pedestrians.iter().copied())?;
        let made = match tracks.window() {
            None => None,
            Some(window) => {
                let window = match &self.place {
                    Some(place) => place.recalling(window),
                    None => window,
                };
                let made = make(&window)?;
                Some((window, made))
            }
        };
        if let Some(place) = &mut self.place {
            // Rows that were left out are not stored. A track that begins anew is not joined to the one before. If only
            // the next row shows that a row is wrong, that row is stored already.
            let rows = pedestrians.into_iter().filter(|(id, _)| !tracks.has_left_out(*id));
            let begun = tracks.misfits().iter();
            let begun = begun.filter(|misfit| misfit.treatment == MisfitTreatment::BegunAnew);
            let begun: Vec<PedestrianId> = begun.map(|misfit| misfit.pedestrian).collect();
            let window = made.as_ref().map(|(window, _)| window);
            place.observe(tracks.last_frame().unwrap_or(frame), rows, &begun, window)?;
        }
        self.tracks = tracks;
        Ok(made)
    }

    /// The tracker restarts: any frame may come next.
    pub(crate) fn clear(&mut self) {
        self.tracks.clear();
        if let Some(place) = &mut self.place {
            place.end_tracks();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::live::place_memory::tests::model;
    use ddl_core::OBSERVED;
    use ddl_data::Clock;

    /// A camera of 7 frames a second: 2.8 frames, or 14 ticks, make a step.
    #[test]
    fn the_memory_holds_the_rows_of_the_tracks() {
        let model = model();
        let clock = Clock::with_frame_time(1.0 / 7.0).unwrap();
        let mut watch = Watch::new(LiveTracks::with_clock(clock));
        let other = watch.remember(&model, Some(SceneMemory::new(3, 9).unwrap()));
        assert!(matches!(other, Err(DdlError::MemoryFrameStep { camera: 14, memory: 3 })));
        watch.remember(&model, None).unwrap();
        // The first pedestrian has an impossible row; the second walks on 2 m aside, as if it were another one.
        let rows = |frame: i64| {
            let along = 0.17 * frame as f64;
            let [wrong, aside] = [frame == 20, frame >= 62].map(|holds| if holds { 2.0 } else { 0.0 });
            vec![(PedestrianId(1), [along, 30.0 * wrong]), (PedestrianId(2), [along, 2.0 + aside])]
        };
        let memory_of = |watch: &Watch| watch.place.as_ref().unwrap().memory().clone();
        let push = |watch: &mut Watch, frame| watch.push(frame, rows(frame), |_| Ok::<_, DdlError>(())).unwrap();
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
        let failed: Result<Option<(Window, ())>, _> = watch.push(125, rows(125), |_| Err(DdlError::Interrupted));
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
