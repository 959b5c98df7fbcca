//! How windows are to be rolled out, and what comes of it.

use ddl_data::Position;
use serde::{Deserialize, Serialize};

/// What the output layer is told besides the pedestrians' features.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Noise {
    /// None: the expectation over the noise, of the metric P for the variants with dynamics, of the
    /// position for the others. One forecast a goal.
    Expected,
    /// That many vectors from N(0, 1), seeded: as many hypotheses on one goal.
    Draws {
        /// Number of vectors.
        count: usize,
        /// Seed of their stream.
        seed: u64,
    },
}

/// How a velocity becomes the next position: which integrator of `ddl-dynamics` a rollout follows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum StepRule {
    /// p + dt v, the published scheme. It may step past the goal and circle it.
    Euler,
    /// The same with P within `ddl_dynamics::MotionBounds`: no step passes the goal, none is faster than the
    /// pedestrian can be, and the last one ends on the goal.
    Bounded,
}

/// Forecast positions of one window.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct WindowRollout {
    /// N, in the order of the window.
    pub pedestrians: usize,
    /// H hypotheses a pedestrian.
    pub hypotheses: usize,
    /// `[N][H][12]`, metres.
    pub positions: Vec<Position>,
    /// `[N][H][12]`: (a, b, c) of L = [[a, 0], [b, c]], in (m/s)^(1/2), with which each position was
    /// reached from the one before; `None` for the variants without dynamics.
    pub factors: Option<Vec<[f64; 3]>>,
}
