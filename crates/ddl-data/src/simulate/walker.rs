//! One walker: where it wants to go, how fast, and when it has got there.

use super::force::WalkingMotion;
use super::layout::Leg;
use super::vector::{add, dot, norm, scale, sub, unit};
use crate::{PedestrianId, Position, TIME_STEP};

/// Integration steps in one step of 0.4 s.
pub(super) const SUBSTEPS: i64 = 8;
/// One integration step (s).
pub(super) const DT: f64 = TIME_STEP / SUBSTEPS as f64;

/// Who comes this close to a place to stand at has arrived (m) ...
pub(super) const ARRIVED: f64 = 0.3;
/// ... and who comes this close settles for it: others may stand there already (m).
const CLOSE_BY: f64 = 1.5;
/// How strongly who is ahead of the group slows down, and who is behind hurries (1/m).
const WAITING: f64 = 0.4;

/// Somebody in the scene.
#[derive(Debug)]
pub(super) struct SimulatedPedestrian {
    pub(super) id: PedestrianId,
    /// The party it came with, as an index.
    pub(super) party: usize,
    pub(super) motion: WalkingMotion,
    /// Where it passes each leg's gate, or stands (m).
    pub(super) targets: Vec<Position>,
    /// The present leg of the route.
    pub(super) leg: usize,
    /// How long it still stands where it stands (s).
    pub(super) rest_left: f64,
    /// Where the present leg began (m).
    pub(super) leg_start: Position,
}

impl SimulatedPedestrian {
    /// Whether the target of the present leg is nearer than the distance (m).
    pub(super) fn is_within(&self, distance: f64) -> bool {
        norm(sub(self.targets[self.leg], self.motion.position)) < distance
    }

    /// The velocity that the walker likes now (m/s).
    pub(super) fn desired(&self, legs: &[Leg], speed: f64, centre: Position) -> Position {
        let target = self.targets[self.leg];
        let way = sub(self.aim(legs, target), self.motion.position);
        if matches!(legs[self.leg], Leg::Stand(_)) && norm(way) < 2.0 * ARRIVED {
            // Slow down smoothly, then stay.
            return scale(way, speed.min(0.8));
        }
        let heading = unit(way);
        let ahead = dot(sub(self.motion.position, centre), heading);
        scale(heading, speed * (1.0 - WAITING * ahead).clamp(0.3, 1.25))
    }

    /// The point to walk to: a gate is walked through, not up to.
    fn aim(&self, legs: &[Leg], target: Position) -> Position {
        match legs[self.leg] {
            Leg::Stand(_) => target,
            Leg::Pass(gate) => add(target, scale(gate.beyond(self.leg_start), 0.8)),
        }
    }

    /// Goes on to the next leg if this one is done.
    pub(super) fn advance(&mut self, legs: &[Leg]) {
        let done = match legs[self.leg] {
            Leg::Pass(gate) => {
                dot(
                    sub(self.motion.position, gate.a),
                    gate.beyond(self.leg_start),
                ) > 0.0
            }
            Leg::Stand(_) => {
                if self.is_within(CLOSE_BY) {
                    self.rest_left -= DT;
                }
                self.rest_left <= 0.0
            }
        };
        if done {
            self.leg += 1;
            self.leg_start = self.motion.position;
        }
    }
}

#[cfg(test)]
mod tests {
    #![expect(clippy::float_cmp, reason = "exact values are what is claimed")]

    use super::super::layout::GateLine;
    use super::*;

    /// At a place, on the way from the origin to a target.
    fn walker(position: Position, target: Position) -> SimulatedPedestrian {
        SimulatedPedestrian {
            id: PedestrianId(1),
            party: 0,
            motion: WalkingMotion {
                position,
                velocity: [1.0, 0.0],
            },
            targets: vec![target, [20.0, 0.0]],
            leg: 0,
            rest_left: 0.1,
            leg_start: [0.0, 0.0],
        }
    }

    fn pass() -> Leg {
        Leg::Pass(GateLine::new([10.0, 1.0], [10.0, -1.0]))
    }

    fn stand() -> Leg {
        Leg::Stand(GateLine::new([0.0, 0.0], [9.0, 0.0]))
    }

    #[test]
    fn within_a_distance_is_nearer_than_it() {
        let walker = walker([0.0, 0.0], [3.0, 4.0]);
        assert!(walker.is_within(5.1) && !walker.is_within(5.0) && !walker.is_within(4.9));
    }

    /// By hand: a gate is aimed at 0.8 m behind it; each metre ahead of the group costs 0.4 of the speed, which stays between 0.3 and 1.25 of
    /// itself; the last 0.6 m to a place to stand are walked more slowly.
    #[test]
    fn the_velocity_that_is_liked() {
        for (leg, place, speed, centre, liked) in [
            (pass(), [0.0, 0.0], 1.5, [-1.0, 0.0], 0.9),
            (pass(), [0.0, 0.0], 1.5, [2.0, 3.0], 1.875),
            (pass(), [0.0, 0.0], 1.5, [-3.0, 0.0], 0.45),
            (pass(), [10.5, 0.0], 1.5, [10.5, 0.0], 1.5),
            (stand(), [8.0, 0.0], 1.5, [8.0, 0.0], 1.5),
            (stand(), [9.5, 0.0], 1.5, [9.5, 0.0], 0.4),
            (stand(), [9.5, 0.0], 0.7, [9.5, 0.0], 0.35),
        ] {
            let found = walker(place, [10.0, 0.0]).desired(&[leg], speed, centre);
            assert!(norm(sub(found, [liked, 0.0])) < 1e-12, "{leg:?}: {found:?}");
        }
        let far = walker([0.0, 0.0], [0.0, 0.6]).desired(&[stand()], 1.5, [0.0, 0.0]);
        assert!(norm(sub(far, [0.0, 1.5])) < 1e-12, "{far:?}");
    }

    /// By hand: a gate is passed behind it, not on it; a rest of 0.1 s is two steps of 0.05 s near the place.
    #[test]
    fn a_leg_is_done_behind_the_gate_or_after_the_rest() {
        let legs = [pass(), pass()];
        for (x, done) in [(9.9, 0), (10.0, 0), (10.1, 1)] {
            let mut walker = walker([x, 0.5], [10.0, 0.0]);
            walker.advance(&legs);
            assert_eq!(walker.leg, done);
            assert_eq!(walker.leg_start, [[0.0, 0.0], [x, 0.5]][done]);
        }
        for (place, legs_done) in [([9.0, 0.0], [0, 1]), ([8.5, 0.0], [0, 0])] {
            let mut walker = walker(place, [10.0, 0.0]);
            for leg in legs_done {
                walker.advance(&[stand(), pass()]);
                assert_eq!(walker.leg, leg);
            }
        }
    }
}
