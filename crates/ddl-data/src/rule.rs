//! Window rules: which stretches of a recording count as windows.

use std::fmt;
use std::str::FromStr;

use ddl_core::UnknownName;
use serde::{Deserialize, Serialize};

/// Smallest number of pedestrians per window in the original code of Social-GAN.
pub(crate) const SOCIAL_GAN_FEWEST: usize = 2;

/// Which stretches of 20 steps count as windows, and which pedestrians belong to them.
///
/// Under every rule a pedestrian belongs to a window if it is present at each of the 20 steps. Pedestrians that arrive
/// or leave meanwhile are left out; under `Observed` they are seen beside it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum WindowRule {
    /// The windows of the published STAR and DDL code, quirks included.
    ///
    /// With the frame step s, an annotated frame f starts a window if frame f + 20 s (one step beyond the window) is
    /// annotated, and at least one pedestrian is in both. A pedestrian at exactly (0, 0) counts as absent at that step.
    /// A fold's tests also lack the window of its very first frame ([`Fold::test_windows`](crate::Fold::test_windows)).
    Published,
    /// Every annotated frame starts a window if at least one pedestrian is present at all of its 20 steps.
    Complete,
    /// The windows of the Social-GAN convention: 20 *annotated* frames in a row, with gaps of any length between them,
    /// and at least `min_pedestrians` present at all of them (0 counts as 1).
    SocialGan {
        /// Smallest number of pedestrians per window: 2 in the original code, 1 in much later work.
        min_pedestrians: usize,
    },
    /// What a live stream would have observed at each moment, on any clock, with the pedestrians tracked for all 20
    /// steps; the others are [bystanders](ddl_core::Window::with_bystanders), which a forecaster sees. Observed
    /// positions are estimates from rows up to the moment ([`LiveTracks`](crate::LiveTracks)); true positions may lie
    /// between two rows.
    Observed,
}

impl fmt::Display for WindowRule {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Published => f.write_str("published"),
            Self::Complete => f.write_str("complete"),
            Self::Observed => f.write_str("observed"),
            Self::SocialGan { min_pedestrians } => {
                write!(f, "social-gan (at least {min_pedestrians} pedestrians)")
            }
        }
    }
}

/// `published`, `complete`, `observed`, `social-gan` (at least 2 pedestrians), or `social-gan-N` for at least N.
impl FromStr for WindowRule {
    type Err = UnknownName;

    fn from_str(word: &str) -> Result<Self, UnknownName> {
        let fewest = match word {
            "published" => return Ok(Self::Published),
            "complete" => return Ok(Self::Complete),
            "observed" => return Ok(Self::Observed),
            "social-gan" => Some(SOCIAL_GAN_FEWEST),
            _ => word.strip_prefix("social-gan-").and_then(|number| number.parse().ok()),
        };
        fewest.filter(|&fewest| fewest > 0).map(|min_pedestrians| Self::SocialGan { min_pedestrians }).ok_or_else(
            || UnknownName {
                kind: "window rule",
                found: word.to_owned(),
                expected: "published, complete, observed, social-gan (at least 2 pedestrians), social-gan-1",
            },
        )
    }
}
