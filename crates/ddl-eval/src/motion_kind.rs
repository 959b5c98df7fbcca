//! Kinds of motion: standing, straight on, turning, slowing down, speeding up.
//!
//! They read the future and group results after the forecasts are made; forecasts must not depend on them.

use ddl_core::{HORIZON, OBSERVED, Position, TIME_STEP, WINDOW, distance};
use serde::{Deserialize, Serialize};

use crate::metric::displacement::{minus, turn};

/// A pedestrian that stays this near to its first position stands (m).
const STANDING: f64 = 1.0;
/// A shorter displacement has no direction (m).
const NO_DIRECTION: f64 = 0.5;
/// Turn below which the motion counts as straight (degrees).
const TURN: f64 = 20.0;
/// Relative change of speed below which the speed counts as the same.
const CHANGE: f64 = 0.3;

/// Kind of motion of a track of 20 positions, with its true future.
///
/// With the observed displacement a = p(8) - p(1) and the true future one b = p(20) - p(8), the first rule that holds:
///
/// ```text
/// standing         every |p(t) - p(1)| < 1 m
/// speeding up      |a| < 0.5 m
/// slowing down     |b| < 0.5 m
/// turning left     angle from a to b >= 20 degrees        (right: <= -20 degrees)
/// slowing down     |b| / 4.8 s <= 0.7 |a| / 2.8 s
/// speeding up      |b| / 4.8 s >= 1.3 |a| / 2.8 s
/// straight on      otherwise
/// ```
///
/// Left is from x to y, counter-clockwise where y points up.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(tag = "motion", rename_all = "kebab-case")]
pub enum MotionKind {
    /// Within 1 m of the first position all the time.
    Standing,
    /// Any other motion.
    Straight,
    /// 20 degrees or more to the left.
    TurningLeft,
    /// 20 degrees or more to the right.
    TurningRight,
    /// At most 0.7 of the observed speed.
    SlowingDown,
    /// At least 1.3 of the observed speed.
    SpeedingUp,
}

ddl_core::named!(
    MotionKind, "kind of motion",
    Standing => "standing", Straight => "straight on", TurningLeft => "turning left", TurningRight => "turning right",
    SlowingDown => "slowing down", SpeedingUp => "speeding up",
);

impl MotionKind {
    /// The kind of motion of a track of 20 positions (m, 0.4 s apart); `None` for other tracks and for positions that
    /// are not finite.
    pub fn of(track: &[Position]) -> Option<Self> {
        if track.len() != WINDOW || !track.iter().flatten().all(|c| c.is_finite()) {
            return None;
        }
        let [first, last, end] = [0, OBSERVED - 1, WINDOW - 1].map(|t| track[t]);
        if track.iter().all(|p| distance(*p, first) < STANDING) {
            return Some(Self::Standing);
        }
        let (observed, future) = (distance(first, last), distance(last, end));
        if observed < NO_DIRECTION {
            return Some(Self::SpeedingUp);
        }
        if future < NO_DIRECTION {
            return Some(Self::SlowingDown);
        }
        let turn = turn(minus(last, first), minus(end, last));
        if turn.abs() >= TURN {
            let left = turn > 0.0;
            return Some(if left { Self::TurningLeft } else { Self::TurningRight });
        }
        let before = observed / ((OBSERVED - 1) as f64 * TIME_STEP);
        let after = future / (HORIZON as f64 * TIME_STEP);
        Some(if after <= (1.0 - CHANGE) * before {
            Self::SlowingDown
        } else if after >= (1.0 + CHANGE) * before {
            Self::SpeedingUp
        } else {
            Self::Straight
        })
    }
}

#[cfg(test)]
mod tests {
    use MotionKind::{SlowingDown, SpeedingUp, Standing, Straight, TurningLeft, TurningRight};

    use super::*;

    /// 7 steps of one velocity, then 12 of another; metres per step.
    fn track(before: Position, after: Position) -> Vec<Position> {
        let steps = [before; OBSERVED - 1].into_iter().chain([after; HORIZON]);
        let mut here = [3.0, -2.0];
        let walked = steps.map(|step| {
            here = [here[0] + step[0], here[1] + step[1]];
            here
        });
        [[3.0, -2.0]].into_iter().chain(walked).collect()
    }

    #[test]
    fn each_kind_is_told_from_the_others() {
        let angle = |degrees: f64| {
            let (sin, cos) = degrees.to_radians().sin_cos();
            [0.5 * cos, 0.5 * sin]
        };
        for (before, after, expected) in [
            ([0.01, 0.0], [0.0, 0.02], Standing),
            ([0.5, 0.0], [0.5, 0.0], Straight),
            ([0.5, 0.0], angle(19.0), Straight),
            ([0.5, 0.0], angle(21.0), TurningLeft),
            ([0.5, 0.0], angle(-21.0), TurningRight),
            ([0.5, 0.0], angle(180.0), TurningLeft),
            ([0.5, 0.0], [0.34, 0.0], SlowingDown),
            ([0.5, 0.0], [0.36, 0.0], Straight),
            ([0.5, 0.0], [0.64, 0.0], Straight),
            ([0.5, 0.0], [0.66, 0.0], SpeedingUp),
            // Within 1 m of the last observed position, but not of the first.
            ([0.1, 0.0], [0.05, 0.0], SlowingDown),
            ([0.02, 0.0], [0.0, 0.09], SpeedingUp),
            ([0.06, 0.0], [0.0, 0.09], SpeedingUp),
            ([0.08, 0.0], [0.0, 0.09], TurningLeft),
            ([0.5, 0.0], [0.0, -0.035], SlowingDown),
            ([0.5, 0.0], [0.0, -0.045], TurningRight),
            // From standing, and to a stand: the direction is noise.
            ([0.0, 0.01], [0.5, 0.0], SpeedingUp),
            ([0.5, 0.0], [0.0, -0.02], SlowingDown),
        ] {
            assert_eq!(MotionKind::of(&track(before, after)), Some(expected), "{after:?}");
        }
    }

    #[test]
    fn a_circle_is_no_standing_and_other_tracks_have_no_kind() {
        let circle: Vec<Position> = (0..WINDOW)
            .map(|t| {
                let (sin, cos) = (t as f64 / (WINDOW - 1) as f64 * std::f64::consts::TAU).sin_cos();
                [2.0 * cos, 2.0 * sin]
            })
            .collect();
        assert_eq!(MotionKind::of(&circle), Some(TurningLeft));
        assert_eq!(MotionKind::of(&circle[1..]), None);
        let mut broken = circle;
        broken[10][1] = f64::NAN;
        assert_eq!(MotionKind::of(&broken), None);
    }
}
