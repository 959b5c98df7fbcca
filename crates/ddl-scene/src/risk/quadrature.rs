//! Deviations of equal probability, by which integrals over the spread are computed.

use std::f64::consts::PI;

/// Number of deviations.
pub(super) const DEVIATIONS: usize = 64;

/// Deviations in two dimensions, in scales of the spread; farther out from one to the next.
#[derive(Debug)]
pub(super) struct Quadrature {
    pub(super) x: [f64; DEVIATIONS],
    pub(super) y: [f64; DEVIATIONS],
}

impl Quadrature {
    /// Deviation j has the distance of the probability (j + 1/2) / 64, and the golden angle to the one before.
    pub(super) fn new() -> Self {
        let golden = PI * (3.0 - 5.0_f64.sqrt());
        let polar = |j: usize| (radius((j as f64 + 0.5) / DEVIATIONS as f64), golden * j as f64);
        Self {
            x: std::array::from_fn(|j| polar(j).0 * polar(j).1.cos()),
            y: std::array::from_fn(|j| polar(j).0 * polar(j).1.sin()),
        }
    }

    /// The distance of the last deviation.
    pub(super) fn farthest() -> f64 {
        radius(1.0 - 0.5 / DEVIATIONS as f64)
    }
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
