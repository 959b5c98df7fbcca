//! One scene that is observed frame by frame: its tracks, and the memory of the place.

use crate::error::DdlError;
use crate::live::place_memory::PlaceMemory;
use ddl_data::{LiveTracks, PedestrianId, Position, Window};

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

    /// Uses this memory of the place from now on.
    ///
    /// # Errors
    /// When it has another number of raw frames per step.
    pub(crate) fn remember(&mut self, place: PlaceMemory) -> Result<(), DdlError> {
        let (camera, memory) = (self.tracks.frame_step(), place.memory().frame_step());
        if camera != memory {
            return Err(DdlError::MemoryFrameStep { camera, memory });
        }
        self.place = Some(place);
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
            place.observe(frame, pedestrians, made.as_ref().map(|(window, _)| window))?;
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
