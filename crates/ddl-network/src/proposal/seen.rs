//! Inputs of the proposal network from the observation.

use crate::ProposalConfig;
use crate::proposal::endpoints::PedestrianView;
use ddl_core::motion::RECENT_STEPS;
use ddl_core::{HORIZON, OBSERVED, Position};

/// Number of inputs for a neighbour: direction (2), two measures of nearness, relative velocity (2), velocity (2),
/// closing speed.
pub(super) const NEIGHBOUR_FEATURES: usize = 9;

/// Features of other pedestrians, for each of B pedestrians.
#[derive(Default)]
pub(super) struct OthersRows {
    /// Number of others of each pedestrian, `[B]`.
    pub(super) counts: Vec<usize>,
    /// `[sum of counts, features]`.
    pub(super) features: Vec<f32>,
}

#[derive(Default)]
pub(super) struct SeenRows {
    /// `[B, 30]`: positions and velocities.
    pub(super) own: Vec<f32>,
    /// Features `[.., 9]`.
    pub(super) neighbours: OthersRows,
    /// Endpoints at constant velocity, `[B]`, metres.
    pub(super) onward: Vec<Position>,
}

impl SeenRows {
    pub(super) fn of(views: &[PedestrianView], config: &ProposalConfig) -> Self {
        let time_step = config.time_step;
        let recent = |track: &[Position]| velocity(track, OBSERVED - 1, time_step);
        let mut seen = Self::default();
        for view in views {
            let track = &view.own;
            let halves = track.as_flattened().iter().map(|x| (x * 0.5) as f32);
            seen.own.extend(halves);
            for pair in track.windows(2) {
                let velocity = [0, 1].map(|axis| ((pair[1][axis] - pair[0][axis]) / time_step) as f32);
                seen.own.extend(velocity);
            }
            let own_velocity = recent(track);
            seen.onward.push(own_velocity.map(|v| v * HORIZON as f64 * time_step));
            let here = track[OBSERVED - 1];
            let neighbours = &mut seen.neighbours;
            let before = neighbours.features.len();
            for neighbour in view.neighbours.iter().take(config.neighbours) {
                let there = neighbour[OBSERVED - 1];
                let offset = [there[0] - here[0], there[1] - here[1]];
                // 1e-6 prevents a division by 0 for a neighbour at the same position.
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
            neighbours.counts.push((neighbours.features.len() - before) / NEIGHBOUR_FEATURES);
        }
        seen
    }
}

/// Mean velocity over the [`RECENT_STEPS`] steps that end at index `until` (m/s).
pub(super) fn velocity(track: &[Position], until: usize, time_step: f64) -> Position {
    let (now, then) = (track[until], track[until - RECENT_STEPS]);
    [0, 1].map(|axis| (now[axis] - then[axis]) / (RECENT_STEPS as f64 * time_step))
}
