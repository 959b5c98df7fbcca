//! How fast a pedestrian was observed to move. Who stands, strolls or walks goes on in other ways, so each pace has its
//! own spread, weights and regions.

use serde::{Deserialize, Serialize};

use crate::position::{Position, distance};

/// The pace of an observed pedestrian, by its mean speed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Pace {
    /// Below 0.15 m/s.
    Standing,
    /// From there to 0.7 m/s.
    Slow,
    /// From there on.
    Walking,
}

impl Pace {
    /// All of them, slowest first.
    pub const ALL: [Self; 3] = [Self::Standing, Self::Slow, Self::Walking];

    /// The pace of a pedestrian observed at these positions (m), `time_step` seconds apart.
    pub fn of(observed: &[Position], time_step: f64) -> Self {
        match mean_speed(observed, time_step) {
            speed if speed < 0.15 => Self::Standing,
            speed if speed < 0.7 => Self::Slow,
            _ => Self::Walking,
        }
    }

    /// Its name in lower case.
    pub fn name(self) -> &'static str {
        match self {
            Self::Standing => "standing",
            Self::Slow => "slow",
            Self::Walking => "walking",
        }
    }
}

/// Length of the observed path (m) divided by its time: m/s; 0 for a single position.
pub fn mean_speed(observed: &[Position], time_step: f64) -> f64 {
    let path: f64 = observed.array_windows().map(|&[a, b]| distance(a, b)).sum();
    let steps = observed.len().saturating_sub(1).max(1);
    path / (steps as f64 * time_step)
}
