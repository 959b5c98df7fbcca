//! The representative hypothesis of a pedestrian: the weighted medoid of its hypotheses.
//!
//! ```text
//! d(k, j) = 1/T sum_t |p_k(t) - p_j(t)|                                     metres
//! k* = argmin_k sum_j w_j d(k, j)
//! ```
//!
//! If the truth were hypothesis `j` with probability `w_j`, the sum would be the expected ADE of hypothesis `k`. The
//! hypothesis with the largest weight ([`Forecast::most_likely`]) may be far from most of the probability.
//!
//! # Numerics
//! O(K^2 T). Expected errors within 1 nm of the smallest count as equal. Of these, the hypothesis with the largest
//! weight is taken, then the first.
//!
//! # References
//! Berger, "Statistical Decision Theory and Bayesian Analysis", 2nd ed. 1985, section 4.4 (Bayes actions); Kaufman,
//! Rousseeuw, "Finding Groups in Data", 1990, chapter 2 (medoids).

use crate::forecast::Forecast;
use crate::position::{Position, distance};

/// Expected errors at most this far apart count as equal, metres.
const EQUAL: f64 = 1e-9;

impl Forecast {
    /// The representative hypothesis of pedestrian `i`: the one with the smallest expected ADE if the truth is one of
    /// the hypotheses.
    pub fn representative(&self, i: usize) -> usize {
        let weights: Vec<f64> = (0..self.hypotheses()).map(|k| self.weight(i, k)).collect();
        medoid(&weights, |k, j| average_displacement(self.hypothesis(i, k), self.hypothesis(i, j)))
    }
}

/// The mean distance of two paths, such as a forecast and the truth: its ADE (m).
///
/// # Panics
/// When the two differ in length or are empty.
pub fn average_displacement(forecast: &[Position], truth: &[Position]) -> f64 {
    assert!(
        forecast.len() == truth.len() && !truth.is_empty(),
        "a forecast of {} positions cannot be compared with {} true ones",
        forecast.len(),
        truth.len()
    );
    let sum: f64 = forecast.iter().zip(truth).map(|(f, t)| distance(*f, *t)).sum();
    sum / truth.len() as f64
}

/// The weighted medoid: `argmin_k sum_j w_j d(k, j)`; of equal ones the one with the largest weight, then the first.
/// Distances are in metres.
///
/// # Panics
/// When there are no weights.
pub fn medoid(weights: &[f64], distance: impl Fn(usize, usize) -> f64) -> usize {
    assert!(!weights.is_empty(), "nothing has no medoid");
    let errors: Vec<f64> = (0..weights.len())
        .map(|k| {
            // Skipped, because a distance may be infinite, and 0 times infinity is NaN.
            let others = weights.iter().enumerate();
            others.filter(|&(j, &weight)| j != k && weight > 0.0).map(|(j, weight)| weight * distance(k, j)).sum()
        })
        .collect();
    let least = errors.iter().copied().fold(f64::INFINITY, f64::min);
    let equals = (0..weights.len()).filter(|&k| errors[k] <= least + EQUAL);
    equals.reduce(|best, k| if weights[k] > weights[best] { k } else { best }).unwrap_or(0)
}
