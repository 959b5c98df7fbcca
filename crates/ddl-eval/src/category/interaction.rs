//! How a pedestrian deals with others: leader-follower, collision avoidance, group, or something else.

use std::fmt;

use ddl_data::{HORIZON, OBSERVED, Position, WINDOW, Window};
use serde::{Deserialize, Serialize};

use crate::{
    metric::displacement::distance,
    vector::{minus, turn},
};

/// Velocities are taken over this many frames.
const STRIDE: usize = 3;
/// Others at this distance or farther do not matter, metres.
const REACH: f64 = 5.0;
/// Half the width of "ahead", and of "in the same direction"; degrees.
const NARROW: f64 = 15.0;
/// Half the width of "at the side"; degrees.
const SIDE: f64 = 45.0;
/// Frames for which a leader must be followed.
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
/// leader-follower        ahead, and |course| <= 15 degrees, at 5 frames or more of one and the same j
/// collision avoidance    ahead, and |course| >= 165 degrees, at 1 frame or more
/// group                  mean of d < 0.8 m and deviation of d < 0.2 m over all 20 frames, and at 1 frame
///                        or more 45 <= |bearing| <= 135 degrees and d < 5 m
/// other                  none of these, while somebody is ahead at 1 frame or more
/// ```
///
/// The frames need not follow one another, and the deviation is that of the population.
///
/// # Where this differs
/// `TrajNet++`'s dataset tool observes 9 frames and judges a group over 21, and takes one border of each sector; here
/// both borders belong to it, so that mirror images are alike. There, who does not move from t - 3 to t walks along x;
/// here nobody is ahead of it or beside it, and it has no course. It sees everybody present at a frame, here only
/// those in the window for all 20.
///
/// # References
/// Kothari, Kreiss, Alahi, "Human Trajectory Forecasting in Crowds", T-ITS 2021, section III.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Interaction {
    /// Follows somebody who goes the same way.
    LeaderFollower,
    /// Somebody comes towards it.
    CollisionAvoidance,
    /// Walks beside somebody.
    Group,
    /// Somebody is ahead, in none of these ways.
    Other,
}

impl Interaction {
    /// Every kind, in the order in which they are shown.
    pub const ALL: [Self; 4] = [
        Self::LeaderFollower,
        Self::CollisionAvoidance,
        Self::Group,
        Self::Other,
    ];

    /// The kinds of pedestrian `i`, in the order of [`Interaction::ALL`]; empty without interaction or future.
    pub fn of(window: &Window, i: usize) -> Vec<Self> {
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
        Self::ALL
            .into_iter()
            .filter(|kind| kinds.contains(kind))
            .collect()
    }

    /// The kinds of pedestrian `i` with pedestrian `j` alone, but for [`Interaction::Other`]; empty without a future, and
    /// for `i == j`.
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

/// Frames at which another pedestrian is where it matters.
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
            // No direction lies along nothing: who stands still has no bearing, nor who is at the same place.
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

    /// The kinds that this encounter makes, in the order of [`Interaction::ALL`].
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

/// Whether two stay near each other over all frames, at much the same distance.
fn keeps_close(me: &[Position], other: &[Position]) -> bool {
    let apart = || me.iter().zip(other).map(|(p, q)| distance(*p, *q));
    let mean = apart().sum::<f64>() / WINDOW as f64;
    let variance = apart().map(|d| (d - mean).powi(2)).sum::<f64>() / WINDOW as f64;
    mean < GROUP_DISTANCE && variance.sqrt() < GROUP_DEVIATION
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::{of_tracks, walking};
    use Interaction::{CollisionAvoidance, Group, LeaderFollower, Other};

    fn pedestrians(all: &[(Position, Position)]) -> Window {
        walking(all, 20)
    }

    const EAST: Position = [0.5, 0.0];
    const ME: (Position, Position) = ([0.0, 0.0], EAST);

    #[test]
    fn who_walks_two_metres_ahead_leads_and_does_not_follow() {
        let window = pedestrians(&[ME, ([2.0, 0.0], EAST)]);
        assert_eq!(Interaction::of(&window, 0), [LeaderFollower]);
        assert_eq!(Interaction::of(&window, 1), []);
        assert_eq!(Interaction::of(&window.without_future(), 0), []);
    }

    /// 5 m is too far, and so is 16 degrees to the side.
    #[test]
    fn the_sector_ahead_is_narrow_and_short() {
        let aside = |degrees: f64, metres: f64| {
            let (sin, cos) = degrees.to_radians().sin_cos();
            Interaction::of(&pedestrians(&[ME, ([metres * cos, metres * sin], EAST)]), 0)
        };
        assert_eq!(aside(14.0, 4.9), [LeaderFollower]);
        assert_eq!(aside(-14.0, 4.9), [LeaderFollower]);
        assert_eq!(aside(16.0, 4.9), []);
        assert_eq!(aside(14.0, 5.0), []);
    }

    /// 16 m apart at frame 0 and nearing by 1 m a frame: 5 m at frame 11 (too far), 4 m at frame 12.
    #[test]
    fn who_comes_towards_it_is_avoided() {
        let window = pedestrians(&[ME, ([16.0, 0.0], [-0.5, 0.0])]);
        assert_eq!(Interaction::of(&window, 0), [CollisionAvoidance]);
        assert_eq!(Interaction::of(&window, 1), [CollisionAvoidance]);
    }

    #[test]
    fn side_by_side_is_a_group_up_to_80_centimetres() {
        let pair = |gap| Interaction::of(&pedestrians(&[ME, ([0.0, gap], EAST)]), 0);
        assert_eq!(pair(0.7), [Group]);
        assert_eq!(pair(-0.7), [Group]);
        assert_eq!(pair(0.9), []);
        // From 0.1 m to 1.05 m apart: 0.575 m on average, with a deviation of 0.29 m.
        let parting = pedestrians(&[ME, ([0.0, 0.1], [0.5, 0.05])]);
        assert_eq!(Interaction::of(&parting, 0), []);
    }

    /// Somebody stands 9 m ahead, of no course: ahead at frames 9 to 17, and no more than that.
    #[test]
    fn who_stands_in_the_way_is_another_interaction() {
        let window = pedestrians(&[ME, ([9.0, 0.0], [0.0, 0.0])]);
        assert_eq!(Interaction::of(&window, 0), [Other]);
        // Who stands has no heading, so that nobody is ahead of it.
        assert_eq!(Interaction::of(&window, 1), []);
    }

    /// Four frames are no following: the leader, 2 m ahead, turns off by a right angle at frame 11 or 12.
    #[test]
    fn following_takes_five_frames() {
        let leader = |turns: i32| {
            let at = |t: i32| {
                [
                    2.0 + 0.5 * f64::from(t.min(turns)),
                    0.5 * f64::from((t - turns).max(0)),
                ]
            };
            (0..20).map(at).collect::<Vec<Position>>()
        };
        let me: Vec<Position> = (0..20).map(|t| [0.5 * f64::from(t), 0.0]).collect();
        let kinds = |turns| Interaction::of(&of_tracks(vec![me.clone(), leader(turns)]), 0);
        // Course 0 at frames 8 to `turns`, counted from 0; one frame later 0.5 m aside for 1 m ahead.
        assert_eq!(kinds(11), [Other]);
        assert_eq!(kinds(12), [LeaderFollower]);
    }

    /// Behind a pair of which one walks beside it: follower and group at once.
    #[test]
    fn a_pedestrian_may_be_of_several_kinds() {
        let window = pedestrians(&[ME, ([0.0, 0.6], EAST), ([1.5, 0.0], EAST)]);
        assert_eq!(Interaction::of(&window, 0), [LeaderFollower, Group]);
    }
}
