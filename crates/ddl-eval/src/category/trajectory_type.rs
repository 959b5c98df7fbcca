//! `TrajNet++`'s four types of trajectory.

use std::fmt;

use ddl_data::{OBSERVED, WINDOW, Window};
use serde::{Deserialize, Serialize};

use super::{interaction::Interaction, kalman::expected_end};
use crate::metric::displacement::distance;

/// Who ends nearer to where it began is static, metres.
const STATIC: f64 = 1.0;
/// Who ends nearer to where a Kalman filter expects it is linear, metres.
const LINEAR: f64 = 0.5;

/// The type of a trajectory in `TrajNet++`'s taxonomy: the first that holds. [`Interaction`] has the rules of III.
///
/// # Where this differs
/// `TrajNet++` has 9 observed frames of 21 and one primary pedestrian a scene; here each pedestrian of a window is
/// judged, over 20. The bound of II is the paper's; the published tool was found with 1 m, and fits its filter first
/// (see `src/category/kalman.rs`). Its data sets keep a tenth of the static scenes; here all count.
///
/// # References
/// Kothari, Kreiss, Alahi, "Human Trajectory Forecasting in Crowds: A Deep Learning Perspective", T-ITS 2021,
/// section III; the tool is `trajnetplusplusdataset`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum TrajectoryType {
    /// I: ends within 1 m of where it began.
    Static,
    /// II: as a Kalman filter expects it.
    Linear,
    /// III: not linear, with somebody ahead or beside it.
    Interacting,
    /// IV: not linear, for no reason to be seen in the others.
    NonInteracting,
}

impl TrajectoryType {
    /// Every type, I to IV.
    pub const ALL: [Self; 4] = [
        Self::Static,
        Self::Linear,
        Self::Interacting,
        Self::NonInteracting,
    ];

    /// The type of pedestrian `i` with the kinds of its interaction, which only type III has.
    pub fn with_interactions(window: &Window, i: usize) -> Option<(Self, Vec<Interaction>)> {
        let end = window.end(i)?;
        let track = window.track(i);
        debug_assert_eq!(track.len(), WINDOW);
        if distance(track[0], end) < STATIC {
            return Some((Self::Static, Vec::new()));
        }
        if distance(expected_end(&track[..OBSERVED]), end) < LINEAR {
            return Some((Self::Linear, Vec::new()));
        }
        let interactions = Interaction::of(window, i);
        let kind = if interactions.is_empty() {
            Self::NonInteracting
        } else {
            Self::Interacting
        };
        Some((kind, interactions))
    }
}

impl fmt::Display for TrajectoryType {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Static => "I static",
            Self::Linear => "II linear",
            Self::Interacting => "III interacting",
            Self::NonInteracting => "IV non-interacting",
        })
    }
}

#[cfg(test)]
mod tests {
    use TrajectoryType::{Linear, NonInteracting, Static};
    use ddl_data::Position;

    use super::*;
    use crate::fixture::of_tracks;

    /// 0.5 m a frame along x, and `aside` a frame along y after the eighth.
    fn turning(aside: f64) -> Vec<Position> {
        let at = |t: i32| [0.5 * f64::from(t), aside * f64::from((t - 7).max(0))];
        (0..20).map(at).collect()
    }

    #[test]
    fn each_type_by_hand() {
        let of = |tracks| {
            TrajectoryType::with_interactions(&of_tracks(tracks), 0)
                .unwrap()
                .0
        };
        // 19 steps of 5 cm are 0.95 m, of 6 cm 1.14 m.
        let slow = |step: f64| (0..20).map(|t| [step * f64::from(t), 0.0]).collect();
        assert_eq!(of(vec![slow(0.05)]), Static);
        assert_eq!(of(vec![slow(0.06)]), Linear);
        // 12 steps aside of 4 cm are 0.48 m, of 5 cm 0.6 m.
        assert_eq!(of(vec![turning(0.04)]), Linear);
        assert_eq!(of(vec![turning(0.05)]), NonInteracting);
        // Who comes back to where it began is static, however far it went.
        let back = (0..20)
            .map(|t: i32| [0.5 * f64::from(10 - (t - 10).abs()), 0.0])
            .collect();
        assert_eq!(of(vec![back]), Static);
    }
}
