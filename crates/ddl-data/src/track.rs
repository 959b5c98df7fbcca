//! A single observation of a pedestrian, and the constants of its sampling.

use std::fmt;

use serde::{Deserialize, Serialize};

/// A place on the ground plane, `[x, y]` in metres.
pub type Position = [f64; 2];

/// Seconds between two steps of a recording (s).
pub const TIME_STEP: f64 = 0.4;
/// Observed steps of a window (3.2 s).
pub const OBSERVED: usize = 8;
/// Steps to forecast (4.8 s).
pub const HORIZON: usize = 12;
/// Steps of a whole window: observed and to forecast.
pub const WINDOW: usize = OBSERVED + HORIZON;

/// Limit of frame numbers: exact in an `f64`, and far from overflow in sums.
pub(crate) const FRAME_LIMIT: i64 = 1 << 53;
pub(crate) const FRAME_STEP_LIMIT: i64 = 1 << 31;

/// Largest coordinate (m) accepted from files and streams; UTM coordinates reach 10,000 km.
pub const COORDINATE_LIMIT: f64 = 1e7;

/// The number of a pedestrian, unique only within its recording.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(transparent)]
pub struct PedestrianId(pub i64);

impl fmt::Display for PedestrianId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

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
        Self {
            frame,
            pedestrian,
            position,
        }
    }
}

pub(crate) fn is_frame(frame: i64) -> bool {
    frame.unsigned_abs() < FRAME_LIMIT.unsigned_abs()
}

pub(crate) fn is_frame_step(step: i64) -> bool {
    (1..=FRAME_STEP_LIMIT).contains(&step)
}

pub(crate) fn is_finite(position: Position) -> bool {
    position.iter().all(|coordinate| coordinate.is_finite())
}

/// The point at `frame` of the straight line between two observations.
pub(crate) fn between(before: (i64, Position), after: (i64, Position), frame: i64) -> Position {
    let share = (frame - before.0) as f64 / (after.0 - before.0) as f64;
    [0, 1].map(|axis| before.1[axis] + share * (after.1[axis] - before.1[axis]))
}
