//! What a proposal network sees of the walkers of a window.

use ddl_data::{OBSERVED, Position, Remembered, Window};
use ddl_goal::{HeadingFrame, TrackError};
use ddl_network::{PedestrianView, ProposalExample, motion_unit};

/// A walker's own frame and unit of length, and what is seen from it.
#[derive(Debug)]
pub(crate) struct Seen {
    pub(crate) frame: HeadingFrame,
    /// Metres a unit of the view.
    pub(crate) unit: f64,
    pub(crate) view: PedestrianView,
}

/// Every pedestrian of a window with its `neighbours` nearest others, from the observed frames, `time_step` seconds apart.
pub(crate) fn of_window(
    window: &Window,
    neighbours: usize,
    time_step: f64,
) -> Result<Vec<Seen>, TrackError> {
    (0..window.len())
        .map(|i| {
            let frame = HeadingFrame::new(window.observed(i))?;
            let unit = motion_unit(window.observed(i), time_step);
            let view = PedestrianView {
                own: in_frame((&frame, unit), window.observed(i)),
                neighbours: nearest(window, i, neighbours)
                    .map(|j| in_frame((&frame, unit), window.observed(j)))
                    .collect(),
                remembered: window
                    .remembered(i)
                    .iter()
                    .map(|other| Remembered {
                        track: in_frame((&frame, unit), &other.track),
                        ..*other
                    })
                    .collect(),
            };
            Ok(Seen { frame, unit, view })
        })
        .collect()
}

/// Every pedestrian of the windows with its future, to learn from; windows without one are left out.
pub(crate) fn examples(
    windows: &[Window],
    neighbours: usize,
    time_step: f64,
) -> Result<Vec<ProposalExample>, TrackError> {
    let mut examples = Vec::new();
    for window in windows.iter().filter(|window| window.has_future()) {
        for (i, seen) in of_window(window, neighbours, time_step)?
            .into_iter()
            .enumerate()
        {
            let future = in_frame((&seen.frame, seen.unit), &window.track(i)[OBSERVED..]);
            let view = seen.view;
            examples.push(ProposalExample { view, future });
        }
    }
    Ok(examples)
}

fn nearest(window: &Window, i: usize, count: usize) -> impl Iterator<Item = usize> {
    let last = |j: usize| window.observed(j)[OBSERVED - 1];
    let here = last(i);
    let mut others: Vec<(f64, usize)> = (0..window.len())
        .filter(|&j| j != i)
        .map(|j| ((last(j)[0] - here[0]).hypot(last(j)[1] - here[1]), j))
        .collect();
    let nearer = |a: &(f64, usize), b: &(f64, usize)| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1));
    // Among thousands only the few that are wanted are put in order.
    if count < others.len() {
        others.select_nth_unstable_by(count, nearer);
        others.truncate(count);
    }
    others.sort_unstable_by(nearer);
    others.into_iter().map(|(_, j)| j)
}

fn in_frame<const T: usize>(
    (frame, unit): (&HeadingFrame, f64),
    track: &[Position],
) -> [Position; T] {
    std::array::from_fn(|t| frame.to_frame(track[t]).map(|coordinate| coordinate / unit))
}
