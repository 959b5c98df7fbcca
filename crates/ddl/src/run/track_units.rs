use ddl_data::Homography;
use serde::{Deserialize, Serialize};

/// What the numbers of somebody's own recordings mean, as far as training was told: at most one of the rates, and a homography where positions are pixels.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct TrackUnits {
    /// Frame numbers count so many a second.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fps: Option<f64>,
    /// Seconds from one frame number to the next.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dt: Option<f64>,
    /// Frame numbers in 0.4 s.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub frame_step: Option<i64>,
    /// From pixels to metres.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub homography: Option<Homography>,
}

impl TrackUnits {
    /// Seconds from one frame number to the next, where `fps` or `dt` says it.
    #[must_use]
    pub fn frame_time(&self) -> Option<f64> {
        self.dt.or(self.fps.map(|fps| 1.0 / fps))
    }

    /// Whether it is said how fast frames follow each other.
    #[must_use]
    pub fn say_the_rate(&self) -> bool {
        self.frame_time().is_some() || self.frame_step.is_some()
    }
}
