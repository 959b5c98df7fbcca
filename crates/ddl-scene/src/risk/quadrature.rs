//! Deviations of equal probability, by which integrals over the spread are computed.

use ddl_simd::{LANES, Lanes};
use std::array::from_fn;
use std::f64::consts::PI;

/// What `f32` may be wrong by.
const ROUNDING: f64 = 1e-6;
/// Number of deviations.
pub(super) const DEVIATIONS: usize = 64;
/// Multiples of these, without their whole parts, fill a square evenly: powers of 1 / 1.3247, the plastic number.
const PLASTIC: [f64; 2] = [0.754_877_666_246_693, 0.569_840_290_998_053];

/// Deviations in two dimensions, in scales of the spread; farther out from one to the next.
#[derive(Debug)]
pub(super) struct Quadrature {
    pub(super) x: [f64; DEVIATIONS],
    pub(super) y: [f64; DEVIATIONS],
}

impl Quadrature {
    /// Those from hypothesis `k`. Deviation j has the distance of the probability (j + u) / 64, and the golden angle to
    /// the one before. The share u, 1/2 for the first hypothesis, and the first angle are others for each, so that
    /// hypotheses that are alike have more deviations together.
    pub(super) fn of_hypothesis(k: usize) -> Self {
        let golden = PI * (3.0 - 5.0_f64.sqrt());
        let share = (0.5 + PLASTIC[0] * k as f64).fract();
        let turn = 2.0 * PI * (PLASTIC[1] * k as f64).fract();
        let polar = |j: usize| (radius((j as f64 + share) / DEVIATIONS as f64), turn + golden * j as f64);
        Self {
            x: std::array::from_fn(|j| polar(j).0 * polar(j).1.cos()),
            y: std::array::from_fn(|j| polar(j).0 * polar(j).1.sin()),
        }
    }

    /// The distance of the last deviation.
    pub(super) fn farthest(&self) -> f64 {
        self.x[DEVIATIONS - 1].hypot(self.y[DEVIATIONS - 1])
    }
}

/// Deviations in `f32`, in blocks one after the other.
#[derive(Debug)]
pub(super) struct DeviationBlocks {
    pub(super) blocks: [[Lanes; 2]; DEVIATIONS / LANES],
    /// None of a block is longer.
    pub(super) most: [f32; DEVIATIONS / LANES],
}

impl DeviationBlocks {
    pub(super) fn of(exact: &Quadrature) -> Self {
        let lanes = |all: &[f64; DEVIATIONS], b: usize| Lanes(from_fn(|j| all[b * LANES + j] as f32));
        let longest = |b: usize| exact.x[(b + 1) * LANES - 1].hypot(exact.y[(b + 1) * LANES - 1]);
        Self {
            blocks: from_fn(|b| [lanes(&exact.x, b), lanes(&exact.y, b)]),
            most: from_fn(|b| (longest(b) * (1.0 + ROUNDING)) as f32),
        }
    }

    /// None is longer.
    pub(super) fn outermost(&self) -> f32 {
        self.most[self.most.len() - 1]
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
