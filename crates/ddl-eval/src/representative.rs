//! One hypothesis to stand for all of a pedestrian: the weighted medoid of their paths.
//!
//! ```text
//! d(k, j) = 1/T sum_t |p_k(t) - p_j(t)|                                     metres
//! k* = argmin_k sum_j w_j d(k, j)
//! ```
//!
//! If the truth were hypothesis `j` with probability `w_j`, then `sum_j w_j d(k, j)` would be the ADE to expect of
//! forecasting `k`: the representative is the Bayes choice among the hypotheses for that error. It is not the
//! hypothesis of greatest weight ([`Forecast::most_likely`]): where goals divide the probability finely, the heaviest
//! of them may stand far from where most of the probability is. It reads the forecast and nothing else.
//!
//! Forecasts without weights count their hypotheses alike, each with 1/K: the representative is then the one of least
//! mean distance from the others. Of two hypotheses it is the heavier.
//!
//! # Numerics
//! O(K^2 T). Expected errors within 1 nm of the least count as equal, for the last digits of a sum depend on the order
//! of its terms: of these the heaviest hypothesis is taken, and of equally heavy ones the first.
//!
//! # References
//! Berger, "Statistical Decision Theory and Bayesian Analysis", 2nd ed. 1985, section 4.4 (Bayes actions); Kaufman,
//! Rousseeuw, "Finding Groups in Data", 1990, chapter 2 (medoids).

use crate::{Forecast, metric::displacement::average_displacement};

/// Expected errors no farther apart than this count as equal, metres.
const EQUAL: f64 = 1e-9;

impl Forecast {
    /// The hypothesis of pedestrian `i` that stands for all: of least expected ADE if the truth is one of them, each with
    /// its weight; `argmin_k sum_j w_j mean_t |p_k(t) - p_j(t)|`, of equals the heaviest, then the first.
    ///
    /// This is the forecast of the protocol `single`, and what is shown and checked for collisions as "the" forecast.
    ///
    /// # Examples
    /// ```
    /// use ddl_eval::Forecast;
    /// // Ends at 0, 10 and 11 m: the first is the heaviest, but most of the probability is around 10 m.
    /// let walks = [0.0, 10.0, 11.0].map(|end| (1..=12).map(move |t| [end * f64::from(t) / 12.0, 0.0]));
    /// let positions = walks.into_iter().flatten().collect();
    /// let forecast = Forecast::new(1, 3, positions, vec![0.4, 0.3, 0.3], None)?;
    /// assert_eq!((forecast.most_likely(0), forecast.representative(0)), (0, 1));
    /// # Ok::<(), ddl_eval::ForecastShapeError>(())
    /// ```
    #[must_use]
    pub fn representative(&self, i: usize) -> usize {
        let weights: Vec<f64> = (0..self.hypotheses()).map(|k| self.weight(i, k)).collect();
        medoid(&weights, |k, j| {
            average_displacement(self.hypothesis(i, k), self.hypothesis(i, j))
        })
    }
}

/// The weighted medoid: `argmin_k sum_j w_j d(k, j)`; of equals the heaviest, then the first.
///
/// [`Forecast::representative`] takes the mean distance of two paths; any other distance in metres will do. What has no
/// weight is asked for no distance to others, but may be the medoid.
///
/// # Panics
/// When there are no weights.
///
/// # Examples
/// ```
/// use ddl_eval::representative::medoid;
/// let ends = [0.0_f64, 10.0, 11.0];
/// let distance = |k: usize, j: usize| (ends[k] - ends[j]).abs();
/// // Expected errors: 0.3 * 10 + 0.3 * 11 = 6.3; 0.4 * 10 + 0.3 * 1 = 4.3; 0.4 * 11 + 0.3 * 1 = 4.7.
/// assert_eq!(medoid(&[0.4, 0.3, 0.3], distance), 1);
/// ```
#[must_use]
pub fn medoid(weights: &[f64], distance: impl Fn(usize, usize) -> f64) -> usize {
    assert!(!weights.is_empty(), "nothing has no medoid");
    let errors: Vec<f64> = (0..weights.len())
        .map(|k| {
            // Skipped and not multiplied: a distance may be too large for a number, and 0 times that is none.
            let others = weights.iter().enumerate();
            others
                .filter(|&(j, &weight)| j != k && weight > 0.0)
                .map(|(j, weight)| weight * distance(k, j))
                .sum()
        })
        .collect();
    let least = errors.iter().copied().fold(f64::INFINITY, f64::min);
    let equals = (0..weights.len()).filter(|&k| errors[k] <= least + EQUAL);
    equals
        .reduce(|best, k| if weights[k] > weights[best] { k } else { best })
        .unwrap_or(0)
}
