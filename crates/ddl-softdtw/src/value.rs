//! The soft-DTW value in `f64` and the log domain: the oracle everything faster is measured against.

use crate::cost::Cost;
use crate::error::{SequenceRole, SoftDtwError};
use crate::softmin::softmin;

/// Soft-DTW with a fixed smoothing γ and cost.
///
/// ```text
/// r(i, j) = δ(x_i, y_j) + min_γ( r(i−1, j−1), r(i−1, j), r(i, j−1) ),   r(0, 0) = 0
/// D_γ(x, y) = r(n, m),   min_γ(a) = −γ ln Σ_k exp(−a_k / γ)
/// ```
///
/// γ = 0 is hard DTW (`min_γ` becomes the minimum). With γ > 0 the value can be negative, and D(x, x) is not 0: see
/// [`SoftDtw::normalised`].
///
/// # Numerics
/// `f64`, log domain: no finite input gives NaN, and the only overflow, a true value beyond the range of `f64`, is an
/// error. `D(x, y)` and `D(y, x)` agree to the last bit.
///
/// # References
/// Cuturi & Blondel, *Soft-DTW: a differentiable loss function for time-series*, ICML 2017, algorithm 1; DDL paper,
/// equations 4 and 5.
///
/// # Examples
/// ```
/// use ddl_softdtw::{Cost, SoftDtw};
/// let dtw = SoftDtw::new(0.0, Cost::SquaredEuclidean)?;
/// // 0 0 1 and 0 1 1 are one shape at two paces: hard DTW sees no difference.
/// assert_eq!(dtw.value(&[[0.0], [0.0], [1.0]], &[[0.0], [1.0], [1.0]])?, 0.0);
/// # Ok::<(), ddl_softdtw::SoftDtwError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SoftDtw {
    gamma: f64,
    cost: Cost,
}

impl SoftDtw {
    /// Soft-DTW with smoothing `gamma` (unit of the cost; 0 = hard DTW).
    ///
    /// # Errors
    /// [`SoftDtwError::InvalidGamma`] when `gamma` is negative, infinite or NaN.
    pub fn new(gamma: f64, cost: Cost) -> Result<Self, SoftDtwError> {
        if gamma.is_finite() && gamma >= 0.0 {
            Ok(Self { gamma, cost })
        } else {
            Err(SoftDtwError::InvalidGamma { gamma })
        }
    }

    /// The smoothing γ.
    pub fn gamma(&self) -> f64 {
        self.gamma
    }

    /// The cost between two steps.
    pub fn cost(&self) -> Cost {
        self.cost
    }

    /// `D_γ(x, y)`, in the unit of the cost.
    ///
    /// # Shapes
    /// `x`: n steps, `y`: m steps, n and m at least 1, not necessarily equal.
    ///
    /// # Errors
    /// An empty sequence, a component that is not finite, or a value beyond the range of `f64`.
    pub fn value<const D: usize>(
        &self,
        x: &[[f64; D]],
        y: &[[f64; D]],
    ) -> Result<f64, SoftDtwError> {
        check(x, SequenceRole::X)?;
        check(y, SequenceRole::Y)?;
        finite(self.value_unchecked(x, y))
    }

    /// `D_γ(x, y) − (D_γ(x, x) + D_γ(y, y)) / 2`, in the unit of the cost: exactly 0 for `x == y`.
    ///
    /// # Errors
    /// As [`SoftDtw::value`].
    ///
    /// # Examples
    /// ```
    /// use ddl_softdtw::{Cost, SoftDtw};
    /// let dtw = SoftDtw::new(1.0, Cost::SquaredEuclidean)?;
    /// let x = [[0.0, 1.0], [0.5, 0.5]];
    /// assert!(dtw.value(&x, &x)? < 0.0);
    /// assert_eq!(dtw.normalised(&x, &x)?, 0.0);
    /// # Ok::<(), ddl_softdtw::SoftDtwError>(())
    /// ```
    pub fn normalised<const D: usize>(
        &self,
        x: &[[f64; D]],
        y: &[[f64; D]],
    ) -> Result<f64, SoftDtwError> {
        let value = self.value(x, y)?;
        finite(normalise(value, self.self_value(x), self.self_value(y)))
    }

    /// `D_γ(x, x)` of a checked sequence. Exactly 0 for γ = 0.
    pub(crate) fn self_value<const D: usize>(&self, x: &[[f64; D]]) -> f64 {
        if self.gamma == 0.0 {
            0.0
        } else {
            self.value_unchecked(x, x)
        }
    }

    /// The recursion, for checked sequences; infinite when the true value exceeds the range of `f64`.
    pub(crate) fn value_unchecked<const D: usize>(&self, x: &[[f64; D]], y: &[[f64; D]]) -> f64 {
        // One row is kept: before cell (i, j) is written, row[j] still holds r(i−1, j).
        let mut row = vec![f64::INFINITY; y.len()];
        let mut corner = 0.0; // r(i−1, 0): 0 above the first row, +inf below it
        for step in x {
            let mut diagonal = corner;
            let mut left = f64::INFINITY;
            for (cell, other) in row.iter_mut().zip(y) {
                let up = *cell;
                left = self.cost.between(step, other) + softmin(diagonal, up, left, self.gamma);
                *cell = left;
                diagonal = up;
            }
            corner = f64::INFINITY;
        }
        row.last().copied().unwrap_or(f64::INFINITY)
    }
}

/// The normalised value from the three plain ones.
pub(crate) fn normalise(value: f64, self_x: f64, self_y: f64) -> f64 {
    // Halves are taken first: the sum of two self terms could overflow where the result does not.
    value - (0.5 * self_x + 0.5 * self_y)
}

pub(crate) fn finite(value: f64) -> Result<f64, SoftDtwError> {
    if value.is_finite() {
        Ok(value)
    } else {
        Err(SoftDtwError::Overflow)
    }
}

/// At least one step, and finite components only.
pub(crate) fn check<const D: usize>(
    steps: &[[f64; D]],
    sequence: SequenceRole,
) -> Result<(), SoftDtwError> {
    if steps.is_empty() {
        return Err(SoftDtwError::EmptySequence { sequence });
    }
    for (step, components) in steps.iter().enumerate() {
        for (component, &value) in components.iter().enumerate() {
            if !value.is_finite() {
                return Err(SoftDtwError::NonFinite {
                    sequence,
                    step,
                    component,
                    value,
                });
            }
        }
    }
    Ok(())
}
