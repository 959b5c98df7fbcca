//! How fast a pedestrian was observed to move. Who stands, strolls or walks goes on in other ways, so each pace has its
//! own spread, weights and regions.

use crate::position::{Position, distance};
use serde::{Deserialize, Serialize};

/// Uncertainty (m) of an observation above which its pace is not known.
const LARGEST_UNCERTAINTY: f64 = 0.3;

/// The pace of an observed pedestrian, by its mean speed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
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

    /// The pace of a pedestrian observed at these positions (m), `time_step` seconds apart, whose observation adds this
    /// [uncertainty](crate::ObservationQuality::uncertainty) (m). Who was hardly observed may as well walk.
    pub fn of(observed: &[Position], time_step: f64, uncertainty: f64) -> Self {
        match mean_speed(observed, time_step) {
            _ if uncertainty > LARGEST_UNCERTAINTY => Self::Walking,
            speed if speed < 0.15 => Self::Standing,
            speed if speed < 0.7 => Self::Slow,
            _ => Self::Walking,
        }
    }
}

/// Length of the observed path (m) divided by its time: m/s; 0 for a single position.
pub fn mean_speed(observed: &[Position], time_step: f64) -> f64 {
    let path: f64 = observed.array_windows().map(|&[a, b]| distance(a, b)).sum();
    let steps = observed.len().saturating_sub(1).max(1);
    path / (steps as f64 * time_step)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paces_by_hand() {
        let cases = [(0.149, Pace::Standing), (0.151, Pace::Slow), (0.699, Pace::Slow), (0.701, Pace::Walking)];
        for (speed, pace) in cases {
            // Half a second for each of two steps.
            let step = 0.5 * speed;
            let observed = [[0.0, 1.0], [0.0, 1.0 + step], [step, 1.0 + step]];
            assert!((mean_speed(&observed, 0.5) - speed).abs() < 1e-12);
            assert_eq!(Pace::of(&observed, 0.5, 0.299), pace);
            assert_eq!(Pace::of(&observed, 0.5, 0.301), Pace::Walking);
        }
        assert_eq!(Pace::of(&[[3.0, 1.0]], 0.4, 0.0), Pace::Standing);
    }
}
