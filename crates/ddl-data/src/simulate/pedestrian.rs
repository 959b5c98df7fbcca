//! A simulated pedestrian: its target, desired velocity and arrival.

use ddl_core::{PedestrianId, Position, TIME_STEP};

use crate::simulate::force::WalkingMotion;
use crate::simulate::layout::RouteLeg;
use crate::simulate::vector::{add, dot, norm, scale, sub, unit};

/// Integration steps per step of 0.4 s.
pub(super) const SUBSTEPS: i64 = 8;
/// One integration step (s).
pub(super) const DT: f64 = TIME_STEP / SUBSTEPS as f64;

/// Distance from its stopping place at which a pedestrian has arrived (m) ...
pub(super) const ARRIVED: f64 = 0.3;
/// ... and distance at which it also stops, because others may occupy the place (m).
const CLOSE_BY: f64 = 1.5;
/// Relative speed change per metre ahead of or behind the group (1/m).
const WAITING: f64 = 0.4;

#[derive(Debug)]
pub(super) struct SimulatedPedestrian {
    pub(super) id: PedestrianId,
    pub(super) party: usize,
    pub(super) motion: WalkingMotion,
    /// Points at which it passes each leg's gate, or stands (m).
    pub(super) targets: Vec<Position>,
    pub(super) leg: usize,
    /// Remaining time of standing (s).
    pub(super) rest_left: f64,
    /// Start of the current leg (m).
    pub(super) leg_start: Position,
}

impl SimulatedPedestrian {
    pub(super) fn is_within(&self, distance: f64) -> bool {
        norm(sub(self.targets[self.leg], self.motion.position)) < distance
    }

    /// The current desired velocity (m/s).
    pub(super) fn desired(&self, legs: &[RouteLeg], speed: f64, centre: Position) -> Position {
        let way = sub(self.aim(legs, self.targets[self.leg]), self.motion.position);
        if matches!(legs[self.leg], RouteLeg::Stand(_)) && norm(way) < 2.0 * ARRIVED {
            // Slow down smoothly, then stand.
            return scale(way, speed.min(0.8));
        }
        let heading = unit(way);
        let ahead = dot(sub(self.motion.position, centre), heading);
        scale(heading, speed * (1.0 - WAITING * ahead).clamp(0.3, 1.25))
    }

    /// The point to aim at: beyond a gate, so that the pedestrian walks through it.
    fn aim(&self, legs: &[RouteLeg], target: Position) -> Position {
        match legs[self.leg] {
            RouteLeg::Stand(_) => target,
            RouteLeg::Pass(gate) => add(target, scale(gate.beyond(self.leg_start), 0.8)),
        }
    }

    pub(super) fn advance(&mut self, legs: &[RouteLeg]) {
        let done = match legs[self.leg] {
            RouteLeg::Pass(gate) => dot(sub(self.motion.position, gate.a), gate.beyond(self.leg_start)) > 0.0,
            RouteLeg::Stand(_) => {
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
