//! The observation of a scene, as a window to forecast from.

use crate::arrays::tracks;
use crate::errors::of_any;
use ddl::data::{Completion, LiveTracks, OBSERVED, PedestrianId, Window};
use numpy::PyReadonlyArray3;
use pyo3::prelude::*;

/// The pedestrians of a scene that can be forecast, and their positions in the user's array.
#[derive(Debug, Clone)]
pub(crate) struct Observed {
    /// `None` when no pedestrian can be forecast.
    pub(crate) window: Option<Window>,
    /// Index in the window of each requested pedestrian; `None` for one that cannot be forecast.
    pub(crate) rows: Vec<Option<usize>>,
}

impl Observed {
    /// The observation of `(n, 8, 2)` positions. The first `asked` pedestrians are forecast; the others are their
    /// neighbours.
    pub(crate) fn new(past: &PyReadonlyArray3<'_, f64>, asked: usize, completion: Completion) -> PyResult<Self> {
        let tracks = tracks("past", past, OBSERVED, true)?;
        let mut live = LiveTracks::new().with_completion(completion);
        for frame in 0..OBSERVED {
            let seen = tracks.iter().enumerate().filter_map(|(i, track)| {
                let position = track[frame];
                let is_seen = !position[0].is_nan();
                is_seen.then_some((PedestrianId(i as i64), position))
            });
            live.push(frame as i64, seen).map_err(of_any)?;
        }
        let window = live.window();
        let mut rows = vec![None; asked];
        for (index, id) in window.iter().flat_map(Window::pedestrians).enumerate() {
            if let Some(row) = rows.get_mut(id.0 as usize) {
                *row = Some(index);
            }
        }
        Ok(Self { window, rows })
    }

    /// All pedestrians of a window, in its order.
    pub(crate) fn of_window(window: Window) -> Self {
        let rows = (0..window.len()).map(Some).collect();
        let window = Some(window);
        Self { window, rows }
    }
}

/// Fills gaps and pads late beginnings, as the program does, unless only whole observations count.
pub(crate) fn completion(whole: bool) -> Completion {
    if whole { Completion::NONE } else { Completion::DEFAULT }
}
