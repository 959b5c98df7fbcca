//! Settings and result of a rollout.

use ddl_core::Position;
use serde::{Deserialize, Serialize};

/// The noise input of the output layer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Noise {
    /// The expectation over the noise: of the metric P for the variants with dynamics, of the position for the others.
    /// One hypothesis for each goal.
    Expected,
    /// Random vectors from N(0, 1): one hypothesis for each vector, all with a single goal.
    Draws {
        /// Number of vectors.
        count: usize,
        /// Seed of the random numbers.
        seed: u64,
    },
}

/// The integrator of `ddl-dynamics` that a rollout uses to get from a velocity to the next position.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum StepRule {
    /// p + dt v, the published scheme. It may step past the goal and circle it.
    Euler,
    /// The stable scheme, with P within `ddl_dynamics::MotionBounds`. No step passes the goal. If the goal can be
    /// reached at the pedestrian's top speed, no step is faster, and the last one ends on the goal.
    Bounded,
}

/// Forecast positions of one window.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct WindowRollout {
    /// The number of pedestrians N, in the order of the window.
    pub pedestrians: usize,
    /// The number of hypotheses H of each pedestrian.
    pub hypotheses: usize,
    /// `[N][H][12]`, metres.
    pub positions: Vec<Position>,
    /// `[N][H][12]`: (a, b, c) of L = [[a, 0], [b, c]], in (m/s)^(1/2), of the step that led to each position. `None`
    /// for the variants without dynamics.
    pub factors: Option<Vec<[f64; 3]>>,
}
