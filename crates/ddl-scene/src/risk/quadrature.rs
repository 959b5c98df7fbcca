//! Deviations of equal probability, by which integrals over the spread are computed.

use ddl_core::Position;
use std::f64::consts::PI;

/// Number of deviations from a hypothesis: each has a bit of a `u64`.
pub(super) const DEVIATIONS: usize = u64::BITS as usize;
/// Multiples of these, without their whole parts, fill a square evenly: powers of 1 / 1.3247, the plastic number.
const PLASTIC: [f64; 2] = [0.754_877_666_246_693, 0.569_840_290_998_053];

/// Deviations from hypothesis `k` in scales of the spread, farther out from one to the next.
///
/// Of n deviations number j has the distance of the probability (j + u) / n, and the golden angle to the one before.
/// The share u, 1/2 for the first hypothesis, and the first angle are others for each, so that hypotheses that are
/// alike have more deviations together.
pub(super) fn deviations_of_hypothesis(k: usize) -> Vec<Position> {
    let golden = PI * (3.0 - 5.0_f64.sqrt());
    let share = (0.5 + PLASTIC[0] * k as f64).fract();
    let turn = 2.0 * PI * (PLASTIC[1] * k as f64).fract();
    let polar = |j: usize| {
        let (sin, cos) = (turn + golden * j as f64).sin_cos();
        [cos, sin].map(|of| radius((j as f64 + share) / DEVIATIONS as f64) * of)
    };
    (0..DEVIATIONS).map(polar).collect()
}

/// Probability that Student's t with 3 degrees of freedom, in two dimensions, lies within a distance (in scales).
pub(crate) fn probability(distance: f64) -> f64 {
    let w = 1.0 + distance * distance / 3.0;
    1.0 - 1.0 / (w * w.sqrt())
}

/// Its inverse.
fn radius(probability: f64) -> f64 {
    (3.0 * ((1.0 - probability).powf(-2.0 / 3.0) - 1.0)).sqrt()
}
