//! Inputs of the memory branch from earlier pedestrians of the place.

use crate::MemoryConfig;
use crate::proposal::endpoints::{ENDPOINT_UNIT, PedestrianView};
use crate::proposal::seen::{OthersRows, velocity};
use ddl_core::motion::RECENT_STEPS;
use ddl_core::{HORIZON, OBSERVED, WINDOW};

/// Number of inputs for an earlier pedestrian: 7 vectors and the [similarities](SIMILARITY_SCALES). Six vectors are
/// relative to the pedestrian: present position, late and early velocity, displacement to the endpoint, endpoint, and
/// displacement to the halfway position. The seventh is its late velocity itself. Displacements and endpoint are
/// relative to the pedestrian's constant velocity.
pub(super) const REMEMBERED_FEATURES: usize = 14 + SIMILARITY_SCALES.len();
/// Scales s of the inputs exp(-d / s), where d is the squared distance of an earlier pedestrian.
pub const SIMILARITY_SCALES: [f64; 3] = [2.0, 8.0, 32.0];

/// Inputs of the memory branch, for the B pedestrians whose views have earlier pedestrians.
#[derive(Default)]
pub(super) struct RememberedRows {
    /// Indices of these pedestrians' views, `[B]`.
    pub(super) of: Vec<usize>,
    /// Features `[.., 17]`.
    pub(super) others: OthersRows,
    /// ln(1 + sum of exp(-d / 2)), `[B]`: the amount of earlier pedestrians that moved similarly.
    pub(super) support: Vec<f32>,
    /// Share of the probability given to the endpoints of the branch, `[B]`.
    pub(super) shares: Vec<f64>,
}

impl RememberedRows {
    pub(super) fn of(views: &[PedestrianView], config: &MemoryConfig, time_step: f64) -> Self {
        let mut rows = Self::default();
        for (index, view) in views.iter().enumerate() {
            let remembered = &view.remembered[..view.remembered.len().min(config.remembered)];
            if remembered.is_empty() {
                continue;
            }
            rows.of.push(index);
            rows.shares.push(config.share(remembered));
            rows.others.counts.push(remembered.len());
            let track = &view.own;
            let here = track[OBSERVED - 1];
            let late = velocity(track, OBSERVED - 1, time_step);
            let early = velocity(track, RECENT_STEPS, time_step);
            let seconds = HORIZON as f64 * time_step;
            let mut support = 0.0;
            for other in remembered {
                let its_track = &other.track;
                let [now, halfway, end] = [OBSERVED - 1, OBSERVED + HORIZON / 2 - 1, WINDOW - 1].map(|t| its_track[t]);
                let its_late = velocity(its_track, OBSERVED - 1, time_step);
                let its_early = velocity(its_track, RECENT_STEPS, time_step);
                let features = [0, 1].map(|axis| {
                    [
                        now[axis] - here[axis],
                        its_late[axis] - late[axis],
                        its_early[axis] - early[axis],
                        (end[axis] - now[axis] - late[axis] * seconds) / ENDPOINT_UNIT,
                        (end[axis] - here[axis] - late[axis] * seconds) / ENDPOINT_UNIT,
                        (halfway[axis] - now[axis] - late[axis] * seconds / 2.0) / ENDPOINT_UNIT,
                        its_late[axis],
                    ]
                });
                let likenesses = SIMILARITY_SCALES.map(|scale| (-other.distance / scale).exp());
                support += likenesses[0];
                let numbers = features.as_flattened().iter().chain(&likenesses);
                rows.others.features.extend(numbers.map(|x| *x as f32));
            }
            rows.support.push(f64::ln_1p(support) as f32);
        }
        rows
    }
}
