//! A single observation of a pedestrian.

use ddl_core::{PedestrianId, Position};
use serde::{Deserialize, Serialize};

/// Position of one pedestrian at one frame.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Observation {
    /// Raw frame number of the recording; steps of 0.4 s are a fixed number of raw frames apart.
    pub frame: i64,
    /// The pedestrian.
    pub pedestrian: PedestrianId,
    /// Its position, `[x, y]` (m).
    pub position: Position,
}

impl Observation {
    /// An observation of a pedestrian at a frame and position (m).
    #[must_use]
    pub fn new(frame: i64, pedestrian: PedestrianId, position: Position) -> Self {
        Self { frame, pedestrian, position }
    }
}
