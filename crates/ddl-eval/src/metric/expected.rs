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

use super::displacement::DisplacementErrors;
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

/// ADE of the most likely hypothesis of pedestrian `i`, metres.
#[must_use]
pub fn most_likely_ade(forecast: &Forecast, errors: &DisplacementErrors, i: usize) -> f64 {
    errors.ade(i)[forecast.most_likely(i)]
}

/// FDE of the most likely hypothesis of pedestrian `i`, metres.
#[must_use]
pub fn most_likely_fde(forecast: &Forecast, errors: &DisplacementErrors, i: usize) -> f64 {
    errors.fde(i)[forecast.most_likely(i)]
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;
    use crate::{
        Scene,
        fixture::{walk, window},
    };

    /// Standing hypotheses 1 m (weight 0.75) and 5 m (0.25) from the truth: 0.75 + 1.25 = 2 m.
    #[test]
    fn weights_decide() {
        let still = [0.0, 0.0];
        let window = window(&[still], &[still]);
        let walks = [walk([3.0, 4.0], still), walk([0.0, 1.0], still)].concat();
        let forecast = Forecast::new(1, 2, walks, vec![0.25, 0.75], None).unwrap();
        let errors = DisplacementErrors::of(&Scene::new(&window, &forecast).unwrap());
        assert_relative_eq!(expected(&forecast, 0, errors.ade(0)), 2.0, epsilon = 1e-12);
        assert_relative_eq!(most_likely_ade(&forecast, &errors, 0), 1.0, epsilon = 1e-12);
        assert_relative_eq!(most_likely_fde(&forecast, &errors, 0), 1.0, epsilon = 1e-12);
    }
}
