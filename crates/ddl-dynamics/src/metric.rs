//! The metric `P = L L^T + sigma I`, stored as its Cholesky factor.

use crate::{
    error::{DynamicsError, ensure_positive},
    real::Real,
    spectrum::{EigenvalueRange, factor_singular_values},
};
use nalgebra::{SMatrix, SVector};

/// The `sigma` of the paper: 1e-8 m/s.
pub const PUBLISHED_SIGMA: f64 = 1e-8;

/// A positive-definite matrix `P = L L^T + sigma I`, given by its lower-triangular factor `L`.
///
/// `P` turns the unit vector towards the goal into a velocity, so its entries, `sigma` and its eigenvalues are in m/s;
/// those of `L` in (m/s)^(1/2). The smallest eigenvalue is at least `sigma`, for every `L`.
///
/// # Numerics
/// `P` is applied through `L`, without forming the matrix. In `f32` a diagonal entry `a * a + 1e-8` rounds to `a * a`
/// as soon as `|a| >= 0.5`, so a matrix that should be positive definite would be singular.
///
/// # References
/// Equations (11) and (12) of the paper.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CholeskyMetric<T, const D: usize> {
    factor: SMatrix<T, D, D>,
    sigma: T,
}

impl<T: Real> CholeskyMetric<T, 2> {
    /// The metric of the plane with `L = [a 0; b c]`: the three outputs of the network.
    ///
    /// # Errors
    /// Those of [`CholeskyMetric::new`].
    pub fn planar(a: T, b: T, c: T, sigma: T) -> Result<Self, DynamicsError> {
        Self::new(SMatrix::<T, 2, 2>::new(a, T::zero(), b, c), sigma)
    }

    /// `axis axis^T + sigma I`, `axis` in (m/s)^(1/2). Both must be finite, and `sigma` positive.
    pub(crate) fn of_axis(axis: SVector<T, 2>, sigma: T) -> Self {
        Self { factor: SMatrix::<T, 2, 2>::new(axis.x, T::zero(), axis.y, T::zero()), sigma }
    }
}

impl<T: Real, const D: usize> CholeskyMetric<T, D> {
    /// The metric with the lower-triangular factor `factor` ((m/s)^(1/2)) and `sigma` (m/s).
    ///
    /// The diagonal of the factor may be zero or negative.
    ///
    /// # Errors
    /// - [`DynamicsError::NotPositive`]: `sigma` is zero, negative, NaN or infinite.
    /// - [`DynamicsError::NonFinite`], [`DynamicsError::NotLowerTriangular`]: an entry of the factor, which the error
    ///   names.
    /// - [`DynamicsError::FactorTooLarge`]: `|L|^2 + sigma` exceeds a quarter of the largest number of `T`. Below that,
    ///   `P u` and `u^T P u` of a unit vector `u` are finite.
    pub fn new(factor: SMatrix<T, D, D>, sigma: T) -> Result<Self, DynamicsError> {
        ensure_positive("sigma, without which P is not positive definite,", "", sigma)?;
        for row in 0..D {
            for column in 0..D {
                let entry = factor[(row, column)];
                let value = entry.as_f64();
                if !entry.is_finite() {
                    let entry = format!("entry ({row}, {column}) of the Cholesky factor");
                    return Err(DynamicsError::NonFinite { entry, value });
                }
                if column > row && !entry.is_zero() {
                    return Err(DynamicsError::NotLowerTriangular { row, column, value });
                }
            }
        }
        if factor.norm_squared() + sigma > T::MAX / T::rounded(4.0) {
            return Err(DynamicsError::FactorTooLarge);
        }
        Ok(Self { factor, sigma })
    }

    /// The identity: `P u = u`, exactly.
    pub fn identity() -> Self {
        Self { factor: SMatrix::zeros(), sigma: T::one() }
    }

    /// The lower-triangular factor `L` ((m/s)^(1/2)).
    pub fn factor(&self) -> &SMatrix<T, D, D> {
        &self.factor
    }

    /// The `sigma` of `P = L L^T + sigma I` (m/s).
    pub fn sigma(&self) -> T {
        self.sigma
    }

    /// `P u = L (L^T u) + sigma u`.
    ///
    /// # Numerics
    /// Where `L^T u` almost cancels (an ill-conditioned factor and `u` near its weak direction), the computed `P u` may
    /// fail to point away from the goal although [`quadratic_form`](Self::quadratic_form) is positive.
    #[inline]
    pub fn apply(&self, u: &SVector<T, D>) -> SVector<T, D> {
        let projected = self.transposed_times(u);
        SVector::from_fn(|row, _| {
            let mut sum = T::zero();
            for column in 0..=row {
                sum += self.factor[(row, column)] * projected[column];
            }
            sum + self.sigma * u[row]
        })
    }

    /// `u^T P u = |L^T u|^2 + sigma |u|^2`: the rate at which the distance to the goal falls (m/s) if `u` is the unit
    /// vector away from it. As a sum of squares it is positive for a unit vector, in `f32` as in `f64`.
    #[inline]
    pub fn quadratic_form(&self, u: &SVector<T, D>) -> T {
        self.transposed_times(u).norm_squared() + self.sigma * u.norm_squared()
    }

    /// `P` as a matrix (m/s), exactly symmetric, see the type's numerics.
    pub(crate) fn to_matrix(self) -> SMatrix<T, D, D> {
        SMatrix::from_fn(|i, j| {
            let mut sum = if i == j { self.sigma } else { T::zero() };
            for k in 0..=i.min(j) {
                sum += self.factor[(i, k)] * self.factor[(j, k)];
            }
            sum
        })
    }

    /// The smallest and the largest eigenvalue of `P` (m/s).
    ///
    /// They are `sigma + s^2` with `s` the singular values of `L`.
    ///
    /// # Numerics
    /// For `D = 1` and `D = 2` in closed form, accurate to a few units in the last place even when `L` is nearly
    /// singular. For other `D` by a singular value decomposition, with an error of a few `epsilon * |L|` in `s`.
    pub fn eigenvalue_range(&self) -> EigenvalueRange<T> {
        let (small, large) = factor_singular_values(&self.factor);
        EigenvalueRange { smallest: self.sigma + small * small, largest: self.sigma + large * large }
    }

    /// `L^T u`, reading the lower triangle only.
    #[inline]
    fn transposed_times(&self, u: &SVector<T, D>) -> SVector<T, D> {
        SVector::from_fn(|column, _| {
            let mut sum = T::zero();
            for row in column..D {
                sum += self.factor[(row, column)] * u[row];
            }
            sum
        })
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{Matrix2, Vector2};

    use super::*;

    #[test]
    fn invalid_metrics_are_refused() {
        let message = |b: f64, above: f64, sigma: f64| {
            CholeskyMetric::new(Matrix2::new(1.0, above, b, 1.0), sigma).unwrap_err().to_string()
        };
        for sigma in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(message(0.0, 0.0, sigma).starts_with("sigma, without which P is not"));
        }
        let infinite = message(f64::INFINITY, 0.0, 1.0);
        assert!(infinite.starts_with("entry (1, 0) of the Cholesky factor is inf"));
        let above = message(0.0, 0.5, 1.0);
        assert!(above.starts_with("entry (0, 1) of the Cholesky factor is 0.5: entries above"));
        let too_large = CholeskyMetric::planar(1e19_f32, 0.0, 0.0, 1.0).unwrap_err();
        assert_eq!(too_large, DynamicsError::FactorTooLarge);
    }

    #[test]
    #[expect(clippy::float_cmp, reason = "the result is exact")]
    fn sigma_is_not_lost_in_single_precision() {
        assert_eq!(0.5_f32 * 0.5 + PUBLISHED_SIGMA as f32, 0.25, "forming P loses sigma");
        // The factor alone gives 0 along u: only sigma remains.
        let metric = CholeskyMetric::planar(1e3_f32, 0.0, 0.0, PUBLISHED_SIGMA as f32).unwrap();
        let u = Vector2::new(0.0, 1.0);
        assert_eq!(metric.quadratic_form(&u), 1e-8);
        assert_eq!(metric.apply(&u), Vector2::new(0.0, 1e-8));
        assert_eq!(metric.eigenvalue_range().smallest, 1e-8);
    }
}
