//! Closed-form invertible maps of space.

use nalgebra::{SMatrix, SVector};

use crate::real::Real;

/// stub
pub trait Diffeomorphism<T: Real, const D: usize> {
    /// psi(x)
    fn apply(&self, position: &SVector<T, D>) -> SVector<T, D>;
    /// inverse
    fn inverse(&self, image: &SVector<T, D>) -> SVector<T, D>;
    /// jacobian
    fn jacobian(&self, position: &SVector<T, D>) -> SMatrix<T, D, D>;
    /// both
    fn apply_with_jacobian(&self, position: &SVector<T, D>) -> (SVector<T, D>, SMatrix<T, D, D>) {
        (self.apply(position), self.jacobian(position))
    }
}
