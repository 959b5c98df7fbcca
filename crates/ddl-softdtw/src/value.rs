//! The soft-DTW value of two sequences.

use crate::error::SoftDtwError;
use crate::grid::Grid;

/// Soft-DTW with a fixed smoothing γ, over all warping paths. The cost δ of two steps is their squared distance: m² for
/// sequences in metres. γ has the unit of the cost.
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
/// With u = 2^−53, D components per step and lengths n and m, the error of the computed value v is at most
///
/// ```text
/// (D + 12) u ( |v| + γ (n + m) )      as a rule,
/// (D + 2 (n + m)) u |v|               for γ = 0 and where a cost may exceed γ · 3.1e15 / (n + m)
/// ```
///
/// Finite input never gives NaN. A value beyond the range of `f64` is an error. `D(x, y)` and `D(y, x)` agree to the
/// last bit.
///
/// # References
/// Cuturi & Blondel, *Soft-DTW: a differentiable loss function for time-series*, ICML 2017, algorithm 1; DDL paper,
/// equations 4 and 5.
///
/// # Examples
/// ```
/// use ddl_softdtw::SoftDtw;
/// let dtw = SoftDtw::new(0.0)?;
/// // 0 0 1 and 0 1 1 are one shape at two paces: hard DTW sees no difference.
/// assert_eq!(dtw.value(&[[0.0], [0.0], [1.0]], &[[0.0], [1.0], [1.0]])?, 0.0);
/// # Ok::<(), ddl_softdtw::SoftDtwError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SoftDtw {
    pub(crate) gamma: f64,
}

impl SoftDtw {
    /// Soft-DTW with smoothing `gamma` (unit of the cost; 0 = hard DTW).
    ///
    /// # Errors
    /// [`SoftDtwError::InvalidGamma`] when `gamma` is negative, infinite or NaN.
    pub fn new(gamma: f64) -> Result<Self, SoftDtwError> {
        if gamma.is_finite() && gamma >= 0.0 { Ok(Self { gamma }) } else { Err(SoftDtwError::InvalidGamma { gamma }) }
    }

    /// `D_γ(x, y)`, in the unit of the cost.
    ///
    /// # Shapes
    /// `x`: n steps, `y`: m steps, n and m at least 1, not necessarily equal. Memory: O(min(n, m)).
    ///
    /// # Errors
    /// An empty sequence, a component that is not finite, or a value beyond the range of `f64`.
    pub fn value<const D: usize>(&self, x: &[[f64; D]], y: &[[f64; D]]) -> Result<f64, SoftDtwError> {
        check(x, 'x')?;
        check(y, 'y')?;
        finite(self.value_unchecked(x, y))
    }

    /// `D_γ(x, y) − (D_γ(x, x) + D_γ(y, y)) / 2`, in the unit of the cost: exactly 0 for `x == y`.
    ///
    /// # Errors
    /// As [`SoftDtw::value`].
    pub fn normalised<const D: usize>(&self, x: &[[f64; D]], y: &[[f64; D]]) -> Result<f64, SoftDtwError> {
        finite(normalise(self.value(x, y)?, self.self_value(x), self.self_value(y)))
    }

    /// `D_γ(x, x)` of a checked sequence. Exactly 0 for γ = 0.
    pub(crate) fn self_value<const D: usize>(self, x: &[[f64; D]]) -> f64 {
        if self.gamma == 0.0 { 0.0 } else { self.value_unchecked(x, x) }
    }

    /// The value of checked sequences; infinite when it exceeds the range of `f64`.
    pub(crate) fn value_unchecked<const D: usize>(self, x: &[[f64; D]], y: &[[f64; D]]) -> f64 {
        // The memory is proportional to the number of columns.
        let (rows, columns) = if x.len() < y.len() { (y, x) } else { (x, y) };
        self.grid(rows, columns).value()
    }

    pub(crate) fn grid<'a, const D: usize>(self, rows: &'a [[f64; D]], columns: &'a [[f64; D]]) -> Grid<'a, D> {
        Grid { rows, columns, gamma: self.gamma }
    }
}

pub(crate) fn normalise(value: f64, self_x: f64, self_y: f64) -> f64 {
    // Each term is halved first, because the sum of both could overflow although the result does not.
    value - (0.5 * self_x + 0.5 * self_y)
}

pub(crate) fn finite(value: f64) -> Result<f64, SoftDtwError> {
    if value.is_finite() { Ok(value) } else { Err(SoftDtwError::Overflow) }
}

/// Checks that the sequence has at least one step and only finite components.
pub(crate) fn check<const D: usize>(steps: &[[f64; D]], sequence: char) -> Result<(), SoftDtwError> {
    if steps.is_empty() {
        return Err(SoftDtwError::EmptySequence { sequence });
    }
    let numbers = steps.as_flattened();
    match numbers.iter().position(|value| !value.is_finite()) {
        None => Ok(()),
        Some(index) => {
            Err(SoftDtwError::NonFinite { sequence, step: index / D, component: index % D, value: numbers[index] })
        }
    }
}
