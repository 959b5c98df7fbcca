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

/// What of a plan people respond to.
#[derive(Debug)]
pub(super) struct SeenPlan {
    /// The distance (m) between centres that counts as close.
    within: f64,
    /// Where it begins, metres.
    start: Position,
    /// How far it leads in 4.8 s, metres.
    displacement: Position,
}

impl SeenPlan {
    /// Of a plan whose edge is close within a distance (m).
    pub(super) fn new(plan: &Plan, within: f64) -> Self {
        let [start, end] = [0.0, TIME_STEP * HORIZON as f64].map(|time| plan.at(time).position);
        let displacement = [0, 1].map(|axis| end[axis] - start[axis]);
        Self { within: within + plan.largest_radius(), start, displacement }
    }
}

impl Response {
    /// Of pedestrian `i` to a plan.
    pub(super) fn to(self, plan: &SeenPlan, futures: &Futures, i: usize) -> PlanResponse {
        let energy = Energy::learned();
        let (factors, logarithm) = match self {
            Self::None => (Vec::new(), 0.0),
            Self::Stranger { crowding } => {
                let present = distance(plan.start, futures.present(i));
                (Vec::new(), energy.avoidance_of_stranger(plan.within, present, crowding))
            }
            Self::Companion { strength, kept } => {
                let apart = |k: usize| {
                    let end = futures.hypotheses().hypothesis(i, k)[HORIZON - 1];
                    let off = |axis: usize| end[axis] - futures.start(i, k)[axis] - plan.displacement[axis];
                    energy.apart(strength, (off(0) * off(0) + off(1) * off(1)) as f32)
                };
                let energies: Vec<f32> = (0..futures.hypotheses().hypotheses()).map(apart).collect();
                // Relative to the likeliest, so that the product over many companions is a number above 0.
                let least = energies.iter().copied().fold(f32::INFINITY, f32::min);
                let factors = energies.into_iter().map(|energy| f64::from(least - energy).exp());
                (factors.collect(), energy.avoidance_of_companion(plan.within, kept))
            }
        };
        PlanResponse { factors, odds: (-logarithm).exp() }
    }
}
