//! The differentiable twin of `ddl-dynamics`: one step of v = -P grad Phi on tensors.
//!
//! The formulas are those of the crate [`ddl_dynamics`]; a test holds the two together.

use serde::{Deserialize, Serialize};
use tch::Tensor;

/// Within this distance, in metres, a walker is at the goal. Squares of smaller offsets underflow in
/// f32, so that nothing below could be told from the goal anyway.
const SMALLEST_NORM: f64 = 1e-18;
/// |P u|^2 is at least sigma^2 away from the goal; this only guards the division at it.
const SMALLEST_SPEED_SQUARED: f64 = 1e-36;

/// How a velocity becomes the next position: which integrator of [`ddl_dynamics`] the tensors follow.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum StepRule {
    /// p + dt v, the published scheme. It may step past the goal and circle it.
    Euler,
    /// The Euler step, shortened where it would pass the point of the step nearest the goal: the
    /// distance to the goal falls at every step, whatever dt.
    StableEuler,
}

/// Constants of the flow.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FlowConstants {
    /// sigma of P = L L^T + sigma I (eq. 11).
    pub sigma: f64,
    /// Seconds a step.
    pub time_step: f64,
    /// How a velocity becomes the next position.
    pub rule: StepRule,
}

/// Next positions under v = -(L L^T + sigma I) u, with u the unit vector away from the goal
/// (paper eq. 7, 9, 11, 12).
///
/// # Shapes
/// `positions` and `goals` broadcast to `[.., 2]`; `factors` `[.., 3]` holds (a, b, c) of
/// L = [[a, 0], [b, c]] -> `[.., 2]`.
///
/// # Numerics
/// P is never formed: P u = L (L^T u) + sigma u, so that sigma survives in f32. At the goal u is 0
/// and so is its derivative: nothing moves and nothing is NaN.
pub fn natural_gradient_step(
    positions: &Tensor,
    goals: &Tensor,
    factors: &Tensor,
    constants: FlowConstants,
) -> Tensor {
    let offset = positions - goals;
    let distance = offset.norm_scalaropt_dim(2, [-1i64].as_slice(), true);
    // Divided by infinity at the goal: u and its derivative are 0 there. Divided by something small, the
    // derivative would be huge, and that of a few steps at the goal no number.
    let at_goal = distance.lt(SMALLEST_NORM);
    let u = &offset / distance.masked_fill(&at_goal, f64::INFINITY);
    let (u1, u2) = (u.narrow(-1, 0, 1), u.narrow(-1, 1, 1));
    let (a, b, c) = (
        factors.narrow(-1, 0, 1),
        factors.narrow(-1, 1, 1),
        factors.narrow(-1, 2, 1),
    );
    // w = L^T u
    let w1 = &a * &u1 + &b * &u2;
    let w2 = &c * &u2;
    let pu1 = &a * &w1 + &u1 * constants.sigma;
    let pu2 = &b * &w1 + &c * &w2 + &u2 * constants.sigma;
    let pu = Tensor::cat(&[&pu1, &pu2], -1);
    let step = match constants.rule {
        StepRule::Euler => pu * constants.time_step,
        StepRule::StableEuler => {
            let decrease =
                w1.square() + w2.square() + (u1.square() + u2.square()) * constants.sigma;
            let speed_squared = pu1.square() + pu2.square();
            let nearest = distance * decrease / speed_squared.clamp_min(SMALLEST_SPEED_SQUARED);
            pu * nearest.clamp_max(constants.time_step)
        }
    };
    positions - step
}
