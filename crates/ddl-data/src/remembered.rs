//! What an earlier pedestrian of the same place did.

use crate::{Position, WINDOW};

/// 20 positions of another pedestrian of the place, who had moved like one that is to be forecast.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Remembered {
    /// `[x, y]` in metres, 0.4 s apart: 8 like those observed now, and the 12 that followed.
    pub track: [Position; WINDOW],
    /// How unlike the first 8 are to those observed now: a squared distance of place and velocities, from 0.
    pub distance: f64,
}
