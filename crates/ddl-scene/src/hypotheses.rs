//! The hypotheses of a scene in `f32`, each relative to the present position of its pedestrian, so that large
//! coordinates lose no digits.

use ddl_core::{Forecast, HORIZON, OBSERVED, Position, Window};
use std::array;
use std::cmp::Ordering;

/// `[axis][t]` relative to the present position of the pedestrian, metres.
pub(crate) type HypothesisPath = [[f32; HORIZON + 1]; 2];

/// The paths of one pedestrian.
#[derive(Debug, Clone)]
pub(crate) struct Hypotheses {
    /// The last observed position, metres.
    pub(crate) present: Position,
    /// `[K]`.
    pub(crate) weights: Vec<f32>,
    /// Coordinates `[axis][t][K]` relative to the present position, metres, at the present and every half step.
    paths: [Vec<f32>; 2],
    /// Largest distance from the present position, metres.
    pub(crate) reach: f64,
    /// Radius of who follows a plan, metres; 0 for a pedestrian. Distances are measured from its edge.
    pub(crate) radius: f64,
}

impl Hypotheses {
    /// Of pedestrian `i` of a forecast.
    pub(crate) fn of(window: &Window, forecast: &Forecast, i: usize) -> Self {
        let present = window.observed(i)[OBSERVED - 1];
        let count = forecast.hypotheses();
        let weights = (0..count).map(|k| forecast.weight(i, k) as f32).collect();
        Self::new(present, weights, |k| forecast.hypothesis(i, k))
    }

    /// One certain path, as of a plan: 12 positions, and the radius of who follows it (m).
    pub(crate) fn certain(present: Position, path: &[Position; HORIZON], radius: f64) -> Self {
        Self { radius, ..Self::new(present, vec![1.0], |_| path) }
    }

    pub(crate) fn new<'a>(present: Position, weights: Vec<f32>, path: impl Fn(usize) -> &'a [Position]) -> Self {
        let count = weights.len();
        let mut paths = [0, 1].map(|_| vec![0.0; (2 * HORIZON + 1) * count]);
        let mut reach = 0.0_f64;
        for k in 0..count {
            for (t, position) in (1..).zip(path(k)) {
                let from_present = [0, 1].map(|axis| position[axis] - present[axis]);
                reach = reach.max(from_present[0].hypot(from_present[1]));
                for axis in 0..2 {
                    let before = paths[axis][(2 * t - 2) * count + k];
                    let position = from_present[axis] as f32;
                    paths[axis][(2 * t - 1) * count + k] = 0.5 * (before + position);
                    paths[axis][2 * t * count + k] = position;
                }
            }
        }
        Self { present, weights, paths, reach, radius: 0.0 }
    }

    /// An order that depends on what they may do, by distances and weights, which a turned scene has too; then by where
    /// they are.
    pub(crate) fn compare(&self, other: &Self) -> Ordering {
        let weights = self.weights.iter().zip(&other.weights).map(|(a, b)| a.total_cmp(b));
        let places = self.present.iter().zip(&other.present).map(|(a, b)| a.total_cmp(b));
        let mut orders = std::iter::once(self.reach.total_cmp(&other.reach)).chain(weights).chain(places);
        orders.find(|order| order.is_ne()).unwrap_or(Ordering::Equal)
    }

    /// Number of hypotheses, K.
    pub(crate) fn count(&self) -> usize {
        self.weights.len()
    }

    /// The x (axis 0) or y (axis 1) of all hypotheses at step `t`, 0 to 12, relative to the present position, metres.
    pub(crate) fn at(&self, axis: usize, t: usize) -> &[f32] {
        self.halfway(axis, 2 * t)
    }

    /// As [`at`](Self::at), for `t` half steps, 0 to 24.
    pub(crate) fn halfway(&self, axis: usize, t: usize) -> &[f32] {
        let count = self.count();
        &self.paths[axis][t * count..][..count]
    }

    /// The path of hypothesis `k`.
    pub(crate) fn path(&self, k: usize) -> HypothesisPath {
        [0, 1].map(|axis| array::from_fn(|t| self.at(axis, t)[k]))
    }

    /// The path of a mixture of the hypotheses.
    pub(crate) fn mean(&self, shares: &[f32]) -> HypothesisPath {
        let mean = |axis: usize, t: usize| self.at(axis, t).iter().zip(shares).map(|(x, share)| x * share).sum();
        [0, 1].map(|axis| array::from_fn(|t| mean(axis, t)))
    }
}

/// The squared least distance of two points that move on straight lines from `from` to `to`, one relative to the other.
pub(crate) fn least_squared(from: [f32; 2], to: [f32; 2]) -> f32 {
    let step = [to[0] - from[0], to[1] - from[1]];
    let length = step[0] * step[0] + step[1] * step[1];
    let along = -(from[0] * step[0] + from[1] * step[1]) / (length + 1e-12);
    // Not `clamp`, which is not computed on vectors.
    let along = if along > 0.0 { along } else { 0.0 };
    let along = if along < 1.0 { along } else { 1.0 };
    let nearest = [from[0] + along * step[0], from[1] + along * step[1]];
    nearest[0] * nearest[0] + nearest[1] * nearest[1]
}
