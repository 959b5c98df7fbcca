//! Smallest and largest eigenvalue of a metric.

use crate::real::Real;
use nalgebra::{DMatrix, SMatrix, SVD};

/// Iterations of the singular value decomposition allowed per dimension; a few are usual.
const ITERATIONS_PER_DIMENSION: usize = 1000;

/// Smallest and largest eigenvalue of a metric (m/s).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EigenvalueRange<T> {
    /// The smallest: the distance to the goal falls at least this fast (m/s).
    pub smallest: T,
    /// The largest: the flow is at most this fast (m/s).
    pub largest: T,
}

pub(crate) fn factor_singular_values<T: Real, const D: usize>(factor: &SMatrix<T, D, D>) -> (T, T) {
    match D {
        0 => (T::zero(), T::zero()),
        1 => (factor[(0, 0)].abs(), factor[(0, 0)].abs()),
        2 => planar(factor[(0, 0)], factor[(1, 0)], factor[(1, 1)]),
        _ => iterative(factor),
    }
}

fn planar<T: Real>(a: T, b: T, c: T) -> (T, T) {
    let (a, c) = (a.abs(), c.abs());
    if c.is_zero() {
        // Both terms of the sum are equal.
        return (T::zero(), a.hypot(b));
    }
    let large = ((a + c).hypot(b) + (a - c).hypot(b)) / T::rounded(2.0);
    if large.is_zero() {
        return (T::zero(), T::zero());
    }
    // |det L| = small * large. Divided first: a * c may underflow although the quotient does not.
    (a.max(c) / large * a.min(c), large)
}

fn iterative<T: Real, const D: usize>(factor: &SMatrix<T, D, D>) -> (T, T) {
    // A dynamically sized matrix uses the general algorithm. nalgebra's special case for 3 x 3 decomposes L^T L and so
    // loses half of the digits of a small singular value.
    let general = DMatrix::from_fn(D, D, |row, column| factor[(row, column)]);
    let decomposition = SVD::try_new_unordered(general, false, false, T::EPSILON, ITERATIONS_PER_DIMENSION * D);
    match decomposition {
        Some(svd) => (svd.singular_values.min(), svd.singular_values.max()),
        // This has never occurred. Both values are still bounds, so every use of them is safe.
        None => (T::zero(), factor.norm()),
    }
}
