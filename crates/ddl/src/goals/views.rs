//! The input of a proposal network for the pedestrians of a window.

use ddl_core::{OBSERVED, Position, RememberedTrack, SpatialIndex, Window};
use ddl_goal::{HeadingFrame, TrackError};
use ddl_network::{PedestrianView, ProposalExample, length_unit};
use rayon::prelude::*;

/// Least pedestrians in the part of a thread.
const PART: usize = 16;

/// A pedestrian's own frame, its unit of length, and the view from it.
#[derive(Debug)]
pub(crate) struct FramedView {
    pub(crate) frame: HeadingFrame,
    /// Metres per unit of length of the view.
    pub(crate) unit: f64,
    pub(crate) view: PedestrianView,
}

/// Views of every pedestrian of a window with its `neighbours` nearest others, from the observed frames (`time_step` in
/// seconds).
pub(crate) fn of_window(window: &Window, neighbours: usize, time_step: f64) -> Result<Vec<FramedView>, TrackError> {
    let last = window.positions_at(OBSERVED - 1);
    let places = SpatialIndex::new(&last);
    let views = (0..window.len()).into_par_iter().with_min_len(PART).map(|i| {
        let frame = HeadingFrame::new(window.observed(i))?;
        let unit = length_unit(window.observed(i), time_step);
        let view = PedestrianView {
            own: in_frame(&frame, unit, window.observed(i)),
            neighbours: places
                .nearest_others(i, last[i], neighbours)
                .into_iter()
                .map(|j| in_frame(&frame, unit, window.observed(j)))
                .collect(),
            remembered: window
                .remembered(i)
                .iter()
                .map(|other| RememberedTrack { track: in_frame(&frame, unit, &other.track), ..*other })
                .collect(),
        };
        Ok(FramedView { frame, unit, view })
    });
    // A parallel collect into a `Result` could return the error of any pedestrian.
    views.collect::<Vec<_>>().into_iter().collect()
}

/// Training examples: every pedestrian of the windows with its future. Windows without a future are left out.
pub(crate) fn examples(
    windows: &[Window],
    neighbours: usize,
    time_step: f64,
) -> Result<Vec<ProposalExample>, TrackError> {
    let mut examples = Vec::new();
    for window in windows.iter().filter(|window| window.has_future()) {
        for (i, seen) in of_window(window, neighbours, time_step)?.into_iter().enumerate() {
            let future = in_frame(&seen.frame, seen.unit, &window.track(i)[OBSERVED..]);
            let view = seen.view;
            examples.push(ProposalExample { view, future });
        }
    }
    Ok(examples)
}

fn in_frame<const T: usize>(frame: &HeadingFrame, unit: f64, track: &[Position]) -> [Position; T] {
    std::array::from_fn(|t| frame.to_frame(track[t]).map(|coordinate| coordinate / unit))
}
