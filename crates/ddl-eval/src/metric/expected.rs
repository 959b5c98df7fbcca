//! Errors of the forecast as a whole, without a choice by the truth: what the weights are worth.
//!
//! ```text
//! expected ADE_i = sum_k w_k ADE_{i,k}        expected FDE_i = sum_k w_k FDE_{i,k}        metres
//! most likely ADE_i = ADE_{i,k*},  FDE_{i,k*} with k* = argmax_k w_k (of equals, the first)
//! ```
//!
//! The expected error is that of a hypothesis drawn with its weight. The most likely hypothesis is not the one of the
//! protocol `single`, the [representative](Forecast::representative) one.

use crate::Forecast;

/// `sum_k w_k e_k` of pedestrian `i`, metres, for its errors `e`, one a hypothesis.
///
/// # Panics
/// When `i` is out of range or there are more errors than hypotheses.
pub fn expected(forecast: &Forecast, i: usize, errors: &[f64]) -> f64 {
    let weighted = errors.iter().enumerate();
    weighted
        .map(|(k, error)| forecast.weight(i, k) * error)
        .sum()
}
