//! What pedestrians see, as the numbers that the network reads.

use super::ends::PedestrianView;
use crate::ProposalConfig;
use ddl_data::{HORIZON, OBSERVED, Position};

/// Time steps over which the present velocity is taken.
pub const RECENT: usize = 3;
/// Inputs of a neighbour: direction, nearness twice, relative and own velocity, closing speed.
pub const NEIGHBOUR_FEATURES: usize = 9;

/// Features of some others of each pedestrian.
#[derive(Default)]
pub(super) struct OthersRows {
    /// How many others each pedestrian has, `[B]`.
    pub(super) counts: Vec<usize>,
    /// `[sum of counts, features]`.
    pub(super) features: Vec<f32>,
}

#[derive(Default)]
pub(super) struct SeenRows {
    /// `[B, 30]`: positions and velocities.
    pub(super) own: Vec<f32>,
    /// `[.., 9]`.
    pub(super) neighbours: OthersRows,
    /// Where the present velocity leads by the end of the horizon, `[B]`, metres.
    pub(super) onward: Vec<Position>,
}

impl SeenRows {
    pub(super) fn of(views: &[PedestrianView], config: &ProposalConfig) -> Self {
        let time_step = config.time_step;
        let recent = |track: &[Position]| velocity(track, OBSERVED - 1, time_step);
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
            let neighbours = &mut seen.neighbours;
            let before = neighbours.features.len();
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
                neighbours.features.extend(features.map(|x| x as f32));
            }
            let rows = (neighbours.features.len() - before) / NEIGHBOUR_FEATURES;
            neighbours.counts.push(rows);
        }
        seen
    }
}

/// Mean velocity over the [`RECENT`] steps that end at index `until` (m/s).
pub(super) fn velocity(track: &[Position], until: usize, time_step: f64) -> Position {
    let (now, then) = (track[until], track[until - RECENT]);
    [0, 1].map(|axis| (now[axis] - then[axis]) / (RECENT as f64 * time_step))
}
