//! How people respond to a plan that they see.
//!
//! Strangers keep away from it: the odds that one comes close are divided by a factor, which is large for those who are
//! far away at the moment, so that they have time, and small where people let others come near. Companions of the
//! pedestrian who follows it go on as the plan does, as in the [energy](crate::energy) of walking together, and keep the
//! distance that they kept.

use crate::{energy::Energy, futures::Futures, plan::Plan};
use ddl_core::{HORIZON, Position, TIME_STEP, distance};

/// How a pedestrian responds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Response {
    /// Not at all, or nobody knows.
    None,
    /// As a stranger, where this share of people lets others come near.
    Stranger { crowding: f64 },
    /// As a companion.
    Companion { strength: f32, kept: f64 },
}

/// What a pedestrian does about one plan.
#[derive(Debug)]
pub(super) struct PlanResponse {
    /// Factors of the probabilities of its hypotheses; empty if they are 1.
    pub(super) factors: Vec<f64>,
    /// What the odds are multiplied by that it comes close.
    pub(super) odds: f64,
}

/// The responses of all to plans that `ego` follows, if it is one of them.
pub(super) fn responses(futures: &Futures, ego: Option<usize>) -> Vec<Response> {
    let crowding = &futures.company().crowding;
    let stranger = |i: usize| Response::Stranger { crowding: crowding[i] };
    let of_stranger = |i: usize| if futures.is_known(i) { stranger(i) } else { Response::None };
    let mut responses: Vec<Response> = (0..futures.pedestrians()).map(of_stranger).collect();
    for (i, tie) in ego.into_iter().flat_map(|ego| futures.company().with(ego)) {
        responses[i] = Response::Companion { strength: tie.strength, kept: tie.kept };
    }
    responses
}

impl Response {
    /// To a plan whose edge is close within a distance (m), of pedestrian `i`.
    pub(super) fn to(self, plan: &Plan, within: f64, futures: &Futures, i: usize) -> PlanResponse {
        let within = within + plan.largest_radius();
        let start = plan.at(0.0).position;
        let (factors, logarithm) = match self {
            Self::None => (Vec::new(), 0.0),
            Self::Stranger { crowding } => {
                let present = distance(start, futures.present(i));
                (Vec::new(), Energy::learned().avoidance_of_stranger(within, present, crowding))
            }
            Self::Companion { strength, kept } => {
                let end = plan.at(TIME_STEP * HORIZON as f64).position;
                let factor = |k: usize| {
                    let path = futures.hypotheses().hypothesis(i, k);
                    let moved = |axis: usize| path[HORIZON - 1][axis] - futures.start(i, k)[axis];
                    let apart: Position = [0, 1].map(|axis| moved(axis) - (end[axis] - start[axis]));
                    let squared = (apart[0] * apart[0] + apart[1] * apart[1]) as f32;
                    f64::from(-Energy::learned().apart(strength, squared)).exp()
                };
                let factors = (0..futures.hypotheses().hypotheses()).map(factor).collect();
                (factors, Energy::learned().avoidance_of_companion(within, kept))
            }
        };
        PlanResponse { factors, odds: (-logarithm).exp() }
    }
}
