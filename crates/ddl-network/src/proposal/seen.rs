//! What pedestrians see, as the numbers that the network reads.

use super::ends::PedestrianView;
use crate::ProposalConfig;
use ddl_data::{HORIZON, OBSERVED, Position};

/// Time steps over which the present velocity is taken.
pub const RECENT: usize = 3;
/// Inputs of a neighbour: direction, nearness twice, relative and own velocity, closing speed.
pub const NEIGHBOUR_FEATURES: usize = 9;

#[derive(Default)]
pub(super) struct SeenRows {
    /// `[B, 30]`: positions and velocities.
    pub(super) own: Vec<f32>,
    /// How many neighbours each of them sees.
    pub(super) counts: Vec<usize>,
    /// `[sum of counts, 9]`.
    pub(super) neighbours: Vec<f32>,
    /// Where the present velocity leads by the end of the horizon, `[B]`, metres.
    pub(super) onward: Vec<Position>,
}

impl SeenRows {
    pub(super) fn of(views: &[PedestrianView], config: &ProposalConfig) -> Self {
        let time_step = config.time_step;
        let seconds = RECENT as f64 * time_step;
        let recent = |track: &[Position; OBSERVED]| {
            let (now, then) = (track[OBSERVED - 1], track[OBSERVED - 1 - RECENT]);
            [0, 1].map(|axis| (now[axis] - then[axis]) / seconds)
        };
        let mut seen = Self::default();
        for view in views {
            let own = &view.own;
            let halves = own.as_flattened().iter().map(|x| (x * 0.5) as f32);
            seen.own.extend(halves);
            for pair in own.windows(2) {
                let velocity =
                    [0, 1].map(|axis| ((pair[1][axis] - pair[0][axis]) / time_step) as f32);
                seen.own.extend(velocity);
            }
            let own_velocity = recent(own);
            seen.onward
                .push(own_velocity.map(|v| v * HORIZON as f64 * time_step));
            let here = own[OBSERVED - 1];
            let before = seen.neighbours.len();
            for neighbour in view.neighbours.iter().take(config.neighbours) {
                let there = neighbour[OBSERVED - 1];
                let offset = [there[0] - here[0], there[1] - here[1]];
                // Not 0 for who stands at the same place: it is divided by.
                let distance = (offset[0].powi(2) + offset[1].powi(2) + 1e-6).sqrt();
                if distance >= config.neighbour_range {
                    continue;
                }
                let velocity = recent(neighbour);
                let relative = [velocity[0] - own_velocity[0], velocity[1] - own_velocity[1]];
                let closing = (offset[0] * relative[0] + offset[1] * relative[1]) / distance;
                let features: [f64; NEIGHBOUR_FEATURES] = [
                    offset[0] / (distance + 1.0),
                    offset[1] / (distance + 1.0),
                    (distance * -0.5).exp(),
                    1.0 / (distance + 0.3),
                    relative[0],
                    relative[1],
                    velocity[0],
                    velocity[1],
                    closing,
                ];
                seen.neighbours.extend(features.map(|x| x as f32));
            }
            let rows = (seen.neighbours.len() - before) / NEIGHBOUR_FEATURES;
            seen.counts.push(rows);
        }
        seen
    }
}
