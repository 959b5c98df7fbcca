//! The units of own recordings, as a run records them.

use ddl_data::Homography;
use serde::{Deserialize, Serialize};

/// The units of own recordings as given to training: at most one of the rates, and a homography where positions are in
/// pixels.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct TrackUnits {
    /// Frame numbers per second.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fps: Option<f64>,
    /// Seconds between consecutive frame numbers.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dt: Option<f64>,
    /// Frame numbers in 0.4 s.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub frame_step: Option<i64>,
    /// The homography from pixels to metres.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub homography: Option<Homography>,
}
