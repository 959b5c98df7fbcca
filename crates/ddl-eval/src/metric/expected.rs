//! Errors of the forecast as a whole, without a choice by the truth: what the weights are worth.
//!
//! ```text
//! expected ADE_i = sum_k w_k ADE_{i,k}        expected FDE_i = sum_k w_k FDE_{i,k}        metres
//! most likely ADE_i = ADE_{i,k*},  FDE_{i,k*} with k* = argmax_k w_k (of equals, the first)
//! ```
//!
//! The expected error is that of a hypothesis drawn with its weight. A best of K does not see weights
//! at all; with equal weights the expected error is the plain mean. The most likely hypothesis says
//! what the greatest weight is worth; it is not the one that the protocol `single` scores, which is the
//! [representative](Forecast::representative) one. With equal weights it is an arbitrary one, the first.

use crate::Forecast;

/// `sum_k w_k e_k` of pedestrian `i`, metres, for its errors `e`, one a hypothesis.
///
/// # Panics
/// When `i` is out of range or there are more errors than hypotheses.
///
/// # Examples
/// ```
/// use ddl_eval::{Forecast, metric::expected::expected};
///
/// let positions = vec![[0.0, 0.0]; 2 * 12];
/// let forecast = Forecast::new(1, 2, positions, vec![0.75, 0.25], None)?;
/// assert_eq!(expected(&forecast, 0, &[0.4, 2.0]), 0.75 * 0.4 + 0.25 * 2.0); // metres
/// # Ok::<(), ddl_eval::ForecastShapeError>(())
/// ```
#[must_use]
pub fn expected(forecast: &Forecast, i: usize, errors: &[f64]) -> f64 {
    let weighted = errors.iter().enumerate();
    weighted
        .map(|(k, error)| forecast.weight(i, k) * error)
        .sum()
}
