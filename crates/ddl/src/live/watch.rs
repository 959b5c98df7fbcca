//! One scene that is observed frame by frame: its tracks, and the memory of the place.

use crate::error::DdlError;
use crate::live::place_memory::PlaceMemory;
use crate::model::ddl::Ddl;
use ddl_data::{LiveTracks, MisfitTreatment, PedestrianId, Position, Window};
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
