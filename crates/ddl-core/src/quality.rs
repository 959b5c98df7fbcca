//! How well the 8 positions of an observation are known.

use serde::{Deserialize, Serialize};

use crate::position::{HORIZON, OBSERVED, Position, TIME_STEP, distance};

/// How well a pedestrian was observed. The default is that of a row at each of the 8 steps: nothing was estimated.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct ObservationQuality {
    /// Number of positions at the start, before the first row of the pedestrian: they continue its motion backwards.
    pub unseen: usize,
    /// Time since the last row (s).
    pub age: f64,
    /// Standard deviation of a coordinate of the last position (m), beyond that of a row ...
    pub deviation: f64,
    /// ... and of the present velocity (m/s), beyond that from 8 rows.
    pub velocity_deviation: f64,
}

impl ObservationQuality {
    /// Standard deviation of a coordinate of the velocity (m/s) above which it is hardly known.
    const HARDLY_KNOWN: f64 = 0.3;

    /// Whether the velocity is hardly known: only the last position was seen, in one row or in few that are close
    /// together.
    pub fn is_hardly_observed(self) -> bool {
        self.unseen == OBSERVED - 1 && self.velocity_deviation > Self::HARDLY_KNOWN
    }

    /// Whether the pedestrian has been tracked for all 8 steps.
    pub fn is_whole(self) -> bool {
        self.unseen == 0
    }

    /// Standard deviation of a coordinate (m) that the observation adds at the end of a forecast, after 4.8 s.
    pub fn uncertainty(self) -> f64 {
        self.deviation_after(HORIZON as f64 * TIME_STEP)
    }

    /// Standard deviation of a coordinate (m) that the observation adds to a forecast `seconds` ahead.
    pub fn deviation_after(self, seconds: f64) -> f64 {
        self.deviation.hypot(seconds * self.velocity_deviation)
    }
}

/// Another explanation of the rows of a pedestrian: the last one may be wrong, or another's.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OtherObservation {
    /// Positions (m), oldest first.
    pub positions: [Position; OBSERVED],
    /// How well they are known.
    pub quality: ObservationQuality,
    /// Weight of this explanation in a forecast, 0 to 1; that of the observation itself is the rest. A doubtful row
    /// weighs less than it is likely, so that whoever was about to come near is not missed.
    pub weight: f64,
}

impl OtherObservation {
    /// The quality of an observation at these 8 positions, beside which there is this one: it adds the deviations of
    /// the last position and of the last step's velocity from their means.
    pub(crate) fn beside(&self, positions: &[Position], quality: ObservationQuality) -> ObservationQuality {
        let share = (self.weight * (1.0 - self.weight) / 2.0).sqrt();
        let last = |track: &[Position]| track[OBSERVED - 1];
        let step = |track: &[Position]| [0, 1].map(|axis| last(track)[axis] - track[OBSERVED - 2][axis]);
        let apart = share * distance(last(positions), last(&self.positions));
        let velocities = share * distance(step(positions), step(&self.positions)) / TIME_STEP;
        ObservationQuality {
            deviation: quality.deviation.hypot(apart),
            velocity_deviation: quality.velocity_deviation.hypot(velocities),
            ..quality
        }
    }
}
