//! Remembered tracks of earlier pedestrians.

use crate::{Position, WINDOW};

/// 20 positions of an earlier pedestrian of the same place that moved like the one to forecast.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Remembered {
    /// `[x, y]` in metres, 0.4 s apart: 8 positions similar to the observed ones, and the 12 that followed.
    pub track: [Position; WINDOW],
    /// Dissimilarity of the first 8 positions to the observed ones: a squared distance of present position and
    /// velocities, at least 0.
    pub distance: f64,
}
