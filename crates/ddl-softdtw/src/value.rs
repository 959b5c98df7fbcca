//! The soft-DTW value of two sequences.

use crate::band::Band;
use crate::cost::Cost;
use crate::error::{SequenceRole, SoftDtwError};
use crate::grid::Grid;
use crate::scalar::Scalar;

/// Soft-DTW with a fixed smoothing γ and cost, and an optional band.
///
/// ```text
/// r(i, j) = δ(x_i, y_j) + min_γ( r(i−1, j−1), r(i−1, j), r(i, j−1) ),   r(0, 0) = 0
/// D_γ(x, y) = r(n, m),   min_γ(a) = −γ ln Σ_k exp(−a_k / γ)
/// ```
///
/// γ = 0 is hard DTW (`min_γ` becomes the minimum). With γ > 0 the value can be negative, and D(x, x) is not 0: see
/// [`SoftDtw::normalised`]. Sequences consist of `f32` or `f64`; γ is an `f64` in both cases.
///
/// # Numerics
/// With u = 2^−53, D components per step and lengths n and m, the error of the computed value v is at most
///
/// ```text
/// (D + 12) u ( |v| + γ (n + m) )      as a rule,
/// (D + 2 (n + m)) u |v|               for γ = 0 and where some cost exceeds γ · 3.1e15 / (n + m)
/// ```
///
/// (for `f32`, plus the rounding of the result). Finite input never gives NaN. A value beyond the range of the number
/// type is an error. `D(x, y)` and `D(y, x)` agree to the last bit.
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
    band: Option<Band>,
}

impl SoftDtw {
    /// Soft-DTW with smoothing `gamma` (unit of the cost; 0 = hard DTW), over all warping paths.
    ///
    /// # Errors
    /// [`SoftDtwError::InvalidGamma`] when `gamma` is negative, infinite or NaN.
    pub fn new(gamma: f64, cost: Cost) -> Result<Self, SoftDtwError> {
        if gamma.is_finite() && gamma >= 0.0 {
            Ok(Self {
                gamma,
                cost,
                band: None,
            })
        } else {
            Err(SoftDtwError::InvalidGamma { gamma })
        }
    }

    /// Restricts the warping paths to `band`. The time of a value is then proportional to the width of the band.
    ///
    /// Searches evaluate pair by pair with a band, which takes up to a hundred times as long.
    #[must_use]
    pub fn with_band(self, band: Band) -> Self {
        Self {
            band: Some(band),
            ..self
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

    /// The band of the warping paths, if any.
    pub fn band(&self) -> Option<Band> {
        self.band
    }

    /// `D_γ(x, y)`, in the unit of the cost.
    ///
    /// # Shapes
    /// `x`: n steps, `y`: m steps, n and m at least 1, not necessarily equal. Memory: O(min(n, m)).
    ///
    /// # Errors
    /// An empty sequence, a component that is not finite, or a value beyond the range of `T`.
    pub fn value<T: Scalar, const D: usize>(&self, x: &[[T; D]], y: &[[T; D]]) -> Result<T, SoftDtwError> {
        check(x, SequenceRole::X)?;
        check(y, SequenceRole::Y)?;
        rounded(self.value_unchecked(x, y))
    }

    /// `D_γ(x, y) − (D_γ(x, x) + D_γ(y, y)) / 2`, in the unit of the cost: exactly 0 for `x == y`.
    ///
    /// The band, if there is one, applies to all three terms.
    ///
    /// # Errors
    /// As [`SoftDtw::value`].
    pub fn normalised<T: Scalar, const D: usize>(&self, x: &[[T; D]], y: &[[T; D]]) -> Result<T, SoftDtwError> {
        check(x, SequenceRole::X)?;
        check(y, SequenceRole::Y)?;
        let value = finite(self.value_unchecked(x, y))?;
        rounded(normalise(value, self.self_value(x), self.self_value(y)))
    }

    /// Whether the kernels that compute many pairs in vector lanes apply. They support neither bands nor other costs.
    pub(crate) fn suits_lanes(&self) -> bool {
        self.gamma > 0.0 && self.cost == Cost::SquaredEuclidean && self.band.is_none()
    }

    /// `D_γ(x, x)` of a checked sequence. Exactly 0 for γ = 0.
    pub(crate) fn self_value<T: Scalar, const D: usize>(&self, x: &[[T; D]]) -> f64 {
        if self.gamma == 0.0 {
            0.0
        } else {
            self.value_unchecked(x, x)
        }
    }

    /// The value of checked sequences; infinite when it exceeds the range of `f64`.
    pub(crate) fn value_unchecked<T: Scalar, const D: usize>(&self, x: &[[T; D]], y: &[[T; D]]) -> f64 {
        let grid = self.grid(x, y);
        grid.value().unwrap_or_else(|| grid.log_domain_value())
    }

    /// The grid of two checked sequences, with the shorter one as columns.
    pub(crate) fn grid<'a, T, const D: usize>(&self, x: &'a [[T; D]], y: &'a [[T; D]]) -> Grid<'a, T, D> {
        let (rows, columns) = if x.len() < y.len() { (y, x) } else { (x, y) };
        Grid {
            rows,
            columns,
            gamma: self.gamma,
            cost: self.cost,
            band: self.band,
        }
    }

    /// [`SoftDtw::value`] by the textbook recursion in the log domain: slow, the reference for tests.
    #[doc(hidden)]
    pub fn log_domain_value<T: Scalar, const D: usize>(&self, x: &[[T; D]], y: &[[T; D]]) -> Result<f64, SoftDtwError> {
        check(x, SequenceRole::X)?;
        check(y, SequenceRole::Y)?;
        finite(self.grid(x, y).log_domain_value())
    }
}

pub(crate) fn normalise(value: f64, self_x: f64, self_y: f64) -> f64 {
    // Each term is halved first, because the sum of both could overflow although the result does not.
    value - (0.5 * self_x + 0.5 * self_y)
}

pub(crate) fn finite(value: f64) -> Result<f64, SoftDtwError> {
    rounded(value)
}

pub(crate) fn rounded<T: Scalar>(value: f64) -> Result<T, SoftDtwError> {
    let rounded = T::rounded(value);
    if rounded.widened().is_finite() {
        Ok(rounded)
    } else {
        Err(SoftDtwError::Overflow)
    }
}

/// Checks that the sequence has at least one step and only finite components.
pub(crate) fn check<T: Scalar, const D: usize>(steps: &[[T; D]], sequence: SequenceRole) -> Result<(), SoftDtwError> {
    if steps.is_empty() {
        return Err(SoftDtwError::EmptySequence { sequence });
    }
    for (step, components) in steps.iter().enumerate() {
        for (component, value) in components.iter().enumerate() {
            let value = value.widened();
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
