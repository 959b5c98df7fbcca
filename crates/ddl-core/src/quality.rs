//! How well the 8 positions of an observation are known.

use serde::{Deserialize, Serialize};

use crate::position::{HORIZON, OBSERVED, TIME_STEP};

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
