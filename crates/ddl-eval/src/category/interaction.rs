//! Interaction of a pedestrian with others: leader-follower, collision avoidance, group, or other.

use std::fmt;

use ddl_core::{HORIZON, OBSERVED, Position, WINDOW, Window, distance};
use serde::{Deserialize, Serialize};

use crate::metric::displacement::{minus, turn};

/// Number of frames over which a velocity is taken.
const STRIDE: usize = 3;
/// Pedestrians at this distance or farther are ignored, metres.
const REACH: f64 = 5.0;
/// Half the width of the sectors "ahead" and "in the same direction", degrees.
const NARROW: f64 = 15.0;
/// Half the width of the sector "at the side", degrees.
const SIDE: f64 = 45.0;
const FOLLOWED: usize = 5;
/// Mean distance below which pedestrians may be a group, metres.
const GROUP_DISTANCE: f64 = 0.8;
/// Deviation of the distance below which pedestrians may be a group, metres.
const GROUP_DEVIATION: f64 = 0.2;

/// A kind of interaction of `TrajNet++`'s type III. A pedestrian may have several.
///
/// For the pedestrian i and another j, at the forecast frames t = 9..20, with v(t) = p(t) - p(t - 3),
/// d(t) = |`p_j(t)` - `p_i(t)`|, the bearing of `p_j(t)` - `p_i(t)` from `v_i(t)`, and the course of `v_j(t)` from
/// `v_i(t)`:
///
/// ```text
/// ahead                  |bearing| <= 15 degrees and d < 5 m
/// leader-follower        ahead, and |course| <= 15 degrees, at 5 frames or more of the same j
/// collision avoidance    ahead, and |course| >= 165 degrees, at 1 frame or more
/// group                  mean of d < 0.8 m and deviation of d < 0.2 m over all 20 frames, and at 1 frame
///                        or more 45 <= |bearing| <= 135 degrees and d < 5 m
/// other                  none of these, but a pedestrian is ahead at 1 frame or more
/// ```
///
/// The frames need not be consecutive, and the deviation is that of the population.
///
/// # Differences from `TrajNet++`
/// `TrajNet++`'s dataset tool observes 9 frames and decides over 21 frames whether pedestrians are a group. It includes
/// one border of each sector; here a sector includes both borders, so that mirror images give the same result. In the
/// tool, a pedestrian that does not move from t - 3 to t walks along x; here it has no direction, so no neighbour is
/// ahead of it or beside it. In the tool, all pedestrians of a frame are neighbours; here only those with all 20 steps.
///
/// # References
/// Kothari, Kreiss, Alahi, "Human Trajectory Forecasting in Crowds", T-ITS 2021, section III.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Interaction {
    /// Follows a pedestrian that walks in the same direction.
    LeaderFollower,
    /// Another pedestrian comes towards it.
    CollisionAvoidance,
    /// Walks beside another pedestrian.
    Group,
    /// Another pedestrian is ahead, and none of the other kinds applies.
    Other,
}

impl Interaction {
    /// All kinds, in display order.
    pub(crate) const ALL: [Self; 4] = [Self::LeaderFollower, Self::CollisionAvoidance, Self::Group, Self::Other];

    /// The kinds of pedestrian `i`, in display order; empty without interaction or future.
    pub(crate) fn of(window: &Window, i: usize) -> Vec<Self> {
        if !window.has_future() {
            return Vec::new();
        }
        let me = window.track(i);
        let (mut ahead, mut kinds) = (false, Vec::new());
        for j in (0..window.len()).filter(|&j| j != i) {
            let seen = Encounter::of(me, window.track(j));
            ahead |= seen.ahead > 0;
            kinds.extend(seen.kinds(me, window.track(j)));
        }
        if kinds.is_empty() && ahead {
            return vec![Self::Other];
        }
        Self::ALL.into_iter().filter(|kind| kinds.contains(kind)).collect()
    }

    /// The kinds of pedestrian `i` with pedestrian `j`, without [`Interaction::Other`]; empty without a future, and for
    /// `i == j`.
    pub fn between(window: &Window, i: usize, j: usize) -> Vec<Self> {
        if i == j || !window.has_future() {
            return Vec::new();
        }
        let (me, other) = (window.track(i), window.track(j));
        Encounter::of(me, other).kinds(me, other)
    }
}

impl fmt::Display for Interaction {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::LeaderFollower => "leader-follower",
            Self::CollisionAvoidance => "collision avoidance",
            Self::Group => "group",
            Self::Other => "other interaction",
        })
    }
}

#[derive(Default)]
struct Encounter {
    ahead: usize,
    followed: usize,
    oncoming: usize,
    beside: usize,
}

impl Encounter {
    fn of(me: &[Position], other: &[Position]) -> Self {
        let mut seen = Self::default();
        for t in OBSERVED..OBSERVED + HORIZON {
            let to = minus(other[t], me[t]);
            let heading = minus(me[t], me[t - STRIDE]);
            // A standing pedestrian, and one at the same position, have no bearing.
            if to[0].hypot(to[1]) >= REACH || heading == [0.0, 0.0] || to == [0.0, 0.0] {
                continue;
            }
            let bearing = turn(heading, to).abs();
            if (90.0 - SIDE..=90.0 + SIDE).contains(&bearing) {
                seen.beside += 1;
            }
            if bearing > NARROW {
                continue;
            }
            seen.ahead += 1;
            let velocity = minus(other[t], other[t - STRIDE]);
            if velocity != [0.0, 0.0] {
                let course = turn(heading, velocity).abs();
                seen.followed += usize::from(course <= NARROW);
                seen.oncoming += usize::from(course >= 180.0 - NARROW);
            }
        }
        seen
    }

    fn kinds(&self, me: &[Position], other: &[Position]) -> Vec<Interaction> {
        let group = self.beside > 0 && keeps_close(me, other);
        [
            (Interaction::LeaderFollower, self.followed >= FOLLOWED),
            (Interaction::CollisionAvoidance, self.oncoming > 0),
            (Interaction::Group, group),
        ]
        .into_iter()
        .filter_map(|(kind, holds)| holds.then_some(kind))
        .collect()
    }
}

fn keeps_close(me: &[Position], other: &[Position]) -> bool {
    let apart = || me.iter().zip(other).map(|(p, q)| distance(*p, *q));
    let mean = apart().sum::<f64>() / WINDOW as f64;
    let variance = apart().map(|d| (d - mean).powi(2)).sum::<f64>() / WINDOW as f64;
    mean < GROUP_DISTANCE && variance.sqrt() < GROUP_DEVIATION
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::walking;
    use Interaction::{CollisionAvoidance, Group, LeaderFollower, Other};

    const EAST: Position = [0.5, 0.0];

    /// A pedestrian that walks from the origin to the east, and others. "Ahead" is within 15 degrees and 5 m. A
    /// pedestrian that comes from 16 m is nearer only at the forecast frames. A group walks at most 0.8 m apart, and
    /// its distance does not change from 0.1 m to 1.05 m. A standing pedestrian has no course.
    #[test]
    fn each_kind_by_hand() {
        let aside = |degrees: f64, metres: f64| {
            let (sin, cos) = degrees.to_radians().sin_cos();
            ([metres * cos, metres * sin], EAST)
        };
        let beside = |gap: f64| ([0.0, gap], EAST);
        for (others, expected) in [
            (vec![aside(0.0, 2.0)], vec![LeaderFollower]),
            (vec![aside(14.0, 4.9)], vec![LeaderFollower]),
            (vec![aside(-14.0, 4.9)], vec![LeaderFollower]),
            (vec![aside(16.0, 4.9)], vec![]),
            (vec![aside(14.0, 5.0)], vec![]),
            (vec![aside(180.0, 2.0)], vec![]),
            (vec![([16.0, 0.0], [-0.5, 0.0])], vec![CollisionAvoidance]),
            (vec![beside(-0.7)], vec![Group]),
            (vec![beside(0.9)], vec![]),
            (vec![([0.0, 0.1], [0.5, 0.05])], vec![]),
            (vec![([9.0, 0.0], [0.0, 0.0])], vec![Other]),
            (vec![beside(0.6), ([1.5, 0.0], EAST)], vec![LeaderFollower, Group]),
        ] {
            let window = walking(&[vec![([0.0, 0.0], EAST)], others].concat(), 20);
            assert_eq!(Interaction::of(&window, 0), expected, "{window:?}");
            assert_eq!(Interaction::of(&window.without_future(), 0), []);
        }
    }
}
