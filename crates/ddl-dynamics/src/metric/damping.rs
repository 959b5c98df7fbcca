//! A metric whose flow is slowed along one direction.

use nalgebra::{SMatrix, SVector, Vector2};

use super::CholeskyMetric;
use crate::{
    error::{DynamicsError, ensure_finite},
    polar::polar,
    real::Real,
};

impl<T: Real, const D: usize> CholeskyMetric<T, D> {
    /// `P` with the velocity along `direction` scaled by `share`, and the smallest possible change otherwise.
    ///
    /// With `n` along `direction` and `q = P n`,
    ///
    /// ```text
    /// P' = P - (1 - share) q q^T / (n^T q)        n^T P' u = share n^T P u   for every u
    /// ```
    ///
    /// As `q q^T / (n^T q) <= P` (Cauchy-Schwarz), `share P <= P' <= P`: the result is positive definite. It depends
    /// continuously on `share` and on `direction`, whose length and sign do not matter.
    ///
    /// # Errors
    /// - [`DynamicsError::InvalidShare`] unless `0 < share <= 1`.
    /// - [`DynamicsError::NoDirection`] if `direction` is zero, [`DynamicsError::NonFinite`] if it is not finite.
    ///
    /// # Numerics
    /// `P` is not formed: with `A = [L, sqrt(sigma) I]`, `P = A A^T` and `y = A^T n`, `P' = A' A'^T` for `A' = A (I - b
    /// y y^T)`, `b = (1 - sqrt(share)) / |y|^2`, whose triangular factor is computed by rotations. A share below
    /// `epsilon^2` times the condition number of `P` is not resolved. The result is `P' (1 + epsilon)`, where the last
    /// term replaces `sigma`.
    pub fn damped_along(&self, direction: &SVector<T, D>, share: T) -> Result<Self, DynamicsError> {
        if !(share > T::zero() && share <= T::one()) {
            return Err(DynamicsError::InvalidShare(share.as_f64()));
        }
        ensure_finite("direction", direction)?;
        let (_, n) = polar(direction);
        if n == SVector::<T, D>::zeros() {
            return Err(DynamicsError::NoDirection);
        }
        let root = self.sigma.sqrt();
        let projected = self.transposed_times(&n);
        // Divided first: the reciprocal of a subnormal number overflows.
        let through = self.apply(&n) / self.quadratic_form(&n) * (T::one() - share.sqrt());
        let factor = lower_triangular(
            self.factor - through * projected.transpose(),
            SMatrix::identity() * root - through * (n * root).transpose(),
        );
        Self::new(factor, remainder(self.sigma * share))
    }
}

/// A `sigma` of the size of the rounding error of the smallest eigenvalue, because the factor already contains all of
/// `P`.
fn remainder<T: Real>(smallest: T) -> T {
    (smallest * T::EPSILON).max(T::MIN_POSITIVE)
}

/// The lower-triangular `F` with `F F^T = left left^T + right right^T`, by Givens rotations of columns.
fn lower_triangular<T: Real, const D: usize>(
    mut left: SMatrix<T, D, D>,
    mut right: SMatrix<T, D, D>,
) -> SMatrix<T, D, D> {
    for row in 0..D {
        for column in row + 1..D {
            let (cosine, sine) = rotation(left[(row, row)], left[(row, column)]);
            for i in row..D {
                let (a, b) = (left[(i, row)], left[(i, column)]);
                left[(i, row)] = cosine * a + sine * b;
                left[(i, column)] = cosine * b - sine * a;
            }
            left[(row, column)] = T::zero();
        }
        for column in 0..D {
            let (cosine, sine) = rotation(left[(row, row)], right[(row, column)]);
            for i in row..D {
                let (a, b) = (left[(i, row)], right[(i, column)]);
                left[(i, row)] = cosine * a + sine * b;
                right[(i, column)] = cosine * b - sine * a;
            }
        }
    }
    left
}

/// Cosine and sine of the rotation that turns `(a, b)` onto the first axis; also where both are subnormal.
fn rotation<T: Real>(a: T, b: T) -> (T, T) {
    let (length, direction) = polar(&Vector2::new(a, b));
    if length.is_zero() {
        (T::one(), T::zero())
    } else {
        (direction.x, direction.y)
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Matrix2;

    use super::*;

    #[test]
    fn a_rotation_by_subnormal_numbers_is_a_rotation() {
        // Entries of a few units of the smallest positive number: their hypotenuse has almost no significant digits.
        let tiny = f64::from_bits(3);
        let left = Matrix2::new(tiny, tiny, 3.0, 4.0);
        let right = Matrix2::new(f64::from_bits(65), 0.0, 12.0, 84.0);
        let factor = lower_triangular(left, right);
        let expected = 9.0 + 16.0 + 144.0 + 7056.0;
        let second = factor.row(1).norm_squared();
        assert!((second / expected - 1.0).abs() < 1e-14, "{second}");
    }
}
