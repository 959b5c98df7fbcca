//! Windows whose futures are replaced by values no walker could have, and whose observation is kept.

use ddl_data::{OBSERVED, Position, WINDOW, Window};

/// A change of the future: what it is called, and the window so changed.
pub type Changed = (&'static str, Window);

/// The window with several kinds of wild future for everybody. NaN is among them: whatever touches
/// it, even to multiply it by nothing, is NaN as well.
#[must_use]
pub fn all(window: &Window) -> Vec<Changed> {
    let n = window.len();
    vec![
        ("NaN", replaced(window, |_, _, _| [f64::NAN; 2])),
        ("the origin", replaced(window, |_, _, _| [0.0; 2])),
        (
            "far away",
            replaced(window, |i, t, _| [1e9 * (i + 1) as f64, -1e7 * t as f64]),
        ),
        (
            "standing still at frame 8",
            replaced(window, |i, _, _| window.observed(i)[OBSERVED - 1]),
        ),
        (
            "the next pedestrian's",
            replaced(window, |i, t, _| window.track((i + 1) % n)[t]),
        ),
        (
            "backwards in time",
            replaced(window, |i, t, _| window.track(i)[WINDOW - 1 + OBSERVED - t]),
        ),
        (
            "a hair off",
            replaced(window, |_, _, p| [p[0].next_up(), p[1].next_down()]),
        ),
    ]
}

/// The window with each position after the observation replaced by `f(pedestrian, frame, position)`,
/// frames counted from 0.
#[must_use]
pub fn replaced(window: &Window, f: impl Fn(usize, usize, Position) -> Position) -> Window {
    window.map_positions(|i, t, p| if t < OBSERVED { p } else { f(i, t, p) })
}
