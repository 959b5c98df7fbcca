//! Whether two pedestrians walk in a group or avoid a collision, as in the taxonomy of `TrajNet++`.
//!
//! For the tracks p of pedestrian i and q of another, of 20 positions (m, 0.4 s apart), at the forecast frames t =
//! 9..20, with the velocity p(t) - p(t - 3), d(t) = |q(t) - p(t)|, and the bearing of q(t) - p(t) from that velocity:
//!
//! ```text
//! collision avoidance    |bearing| <= 15 degrees and d < 5 m, and the other's velocity 165 degrees or more from it, at
//!                        1 frame or more
//! group                  mean of d < 0.8 m and deviation of d < 0.2 m over all 20 frames, and at 1 frame or more 45 <=
//!                        |bearing| <= 135 degrees
//! ```
//!
//! A pedestrian without motion from t - 3 to t has no direction; the published tool lets it walk along x.
//! From Kothari, Kreiss, Alahi, "Human Trajectory Forecasting in Crowds", T-ITS 2021, section III.

use std::ops::RangeInclusive;

use ddl_core::{OBSERVED, Position, WINDOW, distance};

use crate::metric::displacement::{minus, turn};

/// Number of frames over which a velocity is taken.
const STRIDE: usize = 3;
/// Pedestrians at this distance or farther are ignored, metres.
const REACH: f64 = 5.0;
/// Half the width of the sectors "ahead" and "in the opposite direction", degrees.
const NARROW: f64 = 15.0;
/// The bearings "at the side", degrees.
const SIDE: RangeInclusive<f64> = 45.0..=135.0;
/// Mean distance below which pedestrians may be a group, metres.
const GROUP_DISTANCE: f64 = 0.8;
/// Deviation of the distance below which pedestrians may be a group, metres.
const GROUP_DEVIATION: f64 = 0.2;

/// Whether another pedestrian comes towards the first one.
pub fn avoids_collision(track: &[Position], other: &[Position]) -> bool {
    (OBSERVED..WINDOW).any(|t| {
        let ahead = bearing(track, other, t).is_some_and(|bearing| bearing <= NARROW);
        let course = velocity(other, t);
        ahead && course != [0.0, 0.0] && turn(velocity(track, t), course).abs() >= 180.0 - NARROW
    })
}

/// Whether the first pedestrian walks beside the other, close to it all the time.
pub fn is_group(track: &[Position], other: &[Position]) -> bool {
    let apart = || track.iter().zip(other).map(|(p, q)| distance(*p, *q));
    let mean = apart().sum::<f64>() / WINDOW as f64;
    let variance = apart().map(|d| (d - mean).powi(2)).sum::<f64>() / WINDOW as f64;
    let beside = |t| bearing(track, other, t).is_some_and(|bearing| SIDE.contains(&bearing));
    mean < GROUP_DISTANCE && variance.sqrt() < GROUP_DEVIATION && (OBSERVED..WINDOW).any(beside)
}

/// The unsigned bearing of the other from the motion, degrees; `None` beyond reach, for one who stands, and at the same
/// position.
fn bearing(track: &[Position], other: &[Position], t: usize) -> Option<f64> {
    let (heading, to) = (velocity(track, t), minus(other[t], track[t]));
    let is_seen = to[0].hypot(to[1]) < REACH && heading != [0.0, 0.0] && to != [0.0, 0.0];
    is_seen.then(|| turn(heading, to).abs())
}

fn velocity(track: &[Position], t: usize) -> Position {
    minus(track[t], track[t - STRIDE])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::walking;

    const EAST: Position = [0.5, 0.0];

    /// A pedestrian that walks from the origin to the east, and another. "Ahead" is within 15 degrees and 5 m. A
    /// pedestrian that comes from 16 m is nearer only at the forecast frames. A group walks at most 0.8 m apart, and
    /// its distance does not change from 0.1 m to 1.05 m. A standing pedestrian has no course.
    #[test]
    fn each_kind_by_hand() {
        for (other, expected) in [
            (([2.0, 0.0], EAST), [false, false]),
            (([0.7, 0.0], EAST), [false, false]),
            (([16.0, 0.0], [-0.5, 0.0]), [true, false]),
            (([16.0, 1.0], [-0.5, 0.0]), [true, false]),
            (([16.0, 2.0], [-0.5, 0.0]), [false, false]),
            (([9.0, 0.0], [0.0, 0.0]), [false, false]),
            (([0.0, -0.7], EAST), [false, true]),
            (([0.0, 0.9], EAST), [false, false]),
            (([0.0, 0.1], [0.5, 0.05]), [false, false]),
        ] {
            let window = walking(&[([0.0, 0.0], EAST), other], 20);
            let (track, other) = (window.track(0), window.track(1));
            assert_eq!(
                [avoids_collision(track, other), is_group(track, other)],
                expected,
                "{window:?}"
            );
        }
    }
}
