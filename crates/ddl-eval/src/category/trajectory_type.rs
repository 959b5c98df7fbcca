//! `TrajNet++`'s four types of trajectory.

use std::fmt;

use ddl_core::{OBSERVED, WINDOW, Window, distance};
use serde::{Deserialize, Serialize};

use crate::category::interaction::Interaction;
use crate::category::kalman::expected_end;

/// A static trajectory ends nearer to its start than this, metres.
const STATIC: f64 = 1.0;
/// A linear trajectory ends nearer to the expectation of a Kalman filter than this, metres.
const LINEAR: f64 = 0.5;

/// The type of a trajectory in `TrajNet++`'s taxonomy: the first that applies. [`Interaction`] has the rules of III.
///
/// # Differences from `TrajNet++`
/// `TrajNet++` has 9 observed frames of 21 and one primary pedestrian in a scene; here each pedestrian of a window has
/// a type, over 20 frames. The bound of II is the paper's; the published tool uses 1 m, and fits its filter first (see
/// `src/category/kalman.rs`). Its data sets keep a tenth of the static scenes; here all are counted.
///
/// # References
/// Kothari, Kreiss, Alahi, "Human Trajectory Forecasting in Crowds: A Deep Learning Perspective", T-ITS 2021, section
/// III; the tool is `trajnetplusplusdataset`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum TrajectoryType {
    /// I: ends within 1 m of its start.
    Static,
    /// II: ends as a Kalman filter expects.
    Linear,
    /// III: not linear, with another pedestrian ahead or beside it.
    Interacting,
    /// IV: not linear, without interaction.
    NonInteracting,
}

impl TrajectoryType {
    /// All types, I to IV.
    pub(crate) const ALL: [Self; 4] = [Self::Static, Self::Linear, Self::Interacting, Self::NonInteracting];

    /// The type of pedestrian `i` with the kinds of its interaction, which only type III has.
    pub(crate) fn with_interactions(window: &Window, i: usize) -> Option<(Self, Vec<Interaction>)> {
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
    use ddl_core::Position;

    use super::*;
    use crate::fixture::of_tracks;

    /// 0.5 m per frame along x, and `aside` per frame along y after the eighth.
    fn turning(aside: f64) -> Vec<Position> {
        let position = |t: i32| [0.5 * f64::from(t), aside * f64::from((t - 7).max(0))];
        (0..20).map(position).collect()
    }

    #[test]
    fn each_type_by_hand() {
        let kind = |tracks| TrajectoryType::with_interactions(&of_tracks(tracks), 0).unwrap().0;
        // 19 steps of 5 cm are 0.95 m, of 6 cm 1.14 m.
        let slow = |step: f64| (0..20).map(|t| [step * f64::from(t), 0.0]).collect();
        assert_eq!(kind(vec![slow(0.05)]), Static);
        assert_eq!(kind(vec![slow(0.06)]), Linear);
        // 12 steps aside of 4 cm are 0.48 m, of 5 cm 0.6 m.
        assert_eq!(kind(vec![turning(0.04)]), Linear);
        assert_eq!(kind(vec![turning(0.05)]), NonInteracting);
        // A trajectory that returns to its start is static, however long it is.
        let back = (0..20)
            .map(|t: i32| [0.5 * f64::from(10 - (t - 10).abs()), 0.0])
            .collect();
        assert_eq!(kind(vec![back]), Static);
    }
}
