//! What was observed of a scene or recording, as windows to forecast from.

use crate::arrays::tracks;
use ddl::data::{Completeness, LiveError, LiveTracks, Misfit, OBSERVED, PedestrianId, Position, Window};
use numpy::PyReadonlyArray3;
use pyo3::prelude::*;

/// The pedestrians of a scene that can be forecast, and their positions in the user's array.
#[derive(Debug, Clone)]
pub(crate) struct ObservedScene {
    /// `None` when no pedestrian can be forecast.
    pub(crate) window: Option<Window>,
    /// Index in the window of each requested pedestrian; `None` for one that cannot be forecast.
    pub(crate) rows: Vec<Option<usize>>,
    /// The positions that were left out, or begin a track anew; the ticks are steps from 0.
    pub(crate) misfits: Vec<Misfit>,
}

impl ObservedScene {
    /// The observation of 8 positions each, NaN where a pedestrian was not observed. The first `asked` pedestrians are
    /// forecast; the others are their neighbours.
    pub(crate) fn of_tracks(
        tracks: &[Vec<Position>],
        asked: usize,
        completeness: Completeness,
    ) -> Result<Self, LiveError> {
        let mut live = LiveTracks::new().with_completeness(completeness);
        let mut misfits = Vec::new();
        for frame in 0..OBSERVED {
            let seen = tracks.iter().enumerate().filter_map(|(i, track)| {
                let position = track[frame];
                let is_seen = !position[0].is_nan();
                is_seen.then_some((PedestrianId(i as i64), position))
            });
            live.push(frame as i64, seen)?;
            misfits.extend_from_slice(live.misfits());
        }
        let window = live.window();
        let mut rows = vec![None; asked];
        for (index, id) in window.iter().flat_map(Window::pedestrians).enumerate() {
            if let Some(row) = rows.get_mut(id.0 as usize) {
                *row = Some(index);
            }
        }
        Ok(Self { window, rows, misfits })
    }

    /// All pedestrians of a window, in its order.
    pub(crate) fn of_window(window: Window) -> Self {
        let rows = (0..window.len()).map(Some).collect();
        Self { window: Some(window), rows, misfits: Vec::new() }
    }

    /// Text about positions of the array that do not fit their tracks.
    pub(crate) fn doubt(&self) -> Option<String> {
        let place = |misfit: &Misfit| format!("past[{}, {}]", misfit.pedestrian.0, misfit.tick);
        let doubt = Misfit::words(&self.misfits, place)?;
        Some(doubt + "; check that positions are in metres and steps are 0.4 s")
    }
}

/// The tracks of `(n, 8, 2)` positions.
pub(crate) fn past_tracks(past: &PyReadonlyArray3<'_, f64>) -> PyResult<Vec<Vec<Position>>> {
    tracks("past", past, OBSERVED, true)
}
