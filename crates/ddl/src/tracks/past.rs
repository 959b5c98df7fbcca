//! Positions that are given 0.4 s apart, without frames, checked as those of streams are.

use ddl_core::{OBSERVED, PedestrianId, Position, Window};
use ddl_data::{Completeness, LiveError, LiveTracks, Misfit};

/// The pedestrians of a scene that can be forecast, of those whose last 8 positions are given.
///
/// A position that no pedestrian can have reached is left out, or begins the track anew, as in [`LiveTracks`]. Whose
/// positions are all impossible cannot be forecast.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct ObservedPast {
    /// `None` when no pedestrian can be forecast.
    pub window: Option<Window>,
    /// Index in the window of each requested pedestrian; `None` for one that cannot be forecast.
    pub rows: Vec<Option<usize>>,
    /// The positions that were left out, or begin a track anew: pedestrians are counted from 0, ticks are steps from 0.
    pub misfits: Vec<Misfit>,
}

impl ObservedPast {
    /// The observation of 8 positions each (m), 0.4 s apart, NaN where a pedestrian was not observed. The first `asked`
    /// pedestrians are forecast; the others are their neighbours.
    ///
    /// # Errors
    /// A position is infinite or too far away.
    ///
    /// # Panics
    /// When a track has less than 8 positions.
    pub fn of_tracks(tracks: &[Vec<Position>], asked: usize, completeness: Completeness) -> Result<Self, LiveError> {
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
        // Of somebody who was seen more often, one row is left where nobody can have been at the others.
        let count = |track: &Vec<Position>| track.iter().filter(|at| !at[0].is_nan()).count();
        let is_possible = |window: &Window, i: usize| {
            count(&tracks[window.pedestrians()[i].0 as usize]) < 2 || !window.quality(i).is_hardly_observed()
        };
        let window = live.window().and_then(|window| window.filter_pedestrians(|i| is_possible(&window, i)));
        let mut rows = vec![None; asked];
        for (index, id) in window.iter().flat_map(Window::pedestrians).enumerate() {
            if let Some(row) = rows.get_mut(id.0 as usize) {
                *row = Some(index);
            }
        }
        Ok(Self { window, rows, misfits })
    }

    /// All pedestrians of a window, in its order.
    #[must_use]
    pub fn of_window(window: Window) -> Self {
        let rows = (0..window.len()).map(Some).collect();
        Self { window: Some(window), rows, misfits: Vec::new() }
    }
}
