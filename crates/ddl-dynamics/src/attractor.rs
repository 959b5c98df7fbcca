//! The attractor: the distance to the goal, and its gradient.

use crate::{
    error::{DynamicsError, ensure_finite},
    polar::polar_way,
    real::Real,
};
use nalgebra::SVector;

/// The potential `Phi(p) = |p - p*|`, the distance to a goal `p*`; every flow of this crate descends it.
///
/// Its gradient is the unit vector `u = e / |e|` with `e = p - p*`, so a flow down it keeps its speed and arrives in
/// finite time.
///
/// # Shapes
/// `D` components, in metres.
///
/// # References
/// Equation (7) of the paper.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Attractor<T, const D: usize> {
    goal: SVector<T, D>,
}

impl<T: Real, const D: usize> Attractor<T, D> {
    /// The distance to `goal` (metres).
    ///
    /// # Errors
    /// [`DynamicsError::NonFinite`] if a component of the goal is NaN or infinite.
    pub fn new(goal: SVector<T, D>) -> Result<Self, DynamicsError> {
        ensure_finite("goal", &goal)?;
        Ok(Self { goal })
    }

    /// The goal `p*` (metres).
    pub fn goal(&self) -> &SVector<T, D> {
        &self.goal
    }

    /// The potential: the distance to the goal, `|p - p*|` (metres).
    ///
    /// # Numerics
    /// Zero only if `position` equals the goal component by component; squares that underflow or overflow are handled.
    /// A distance above the largest number of `T` is infinite.
    #[inline]
    pub fn distance(&self, position: &SVector<T, D>) -> T {
        self.distance_and_gradient(position).0
    }

    /// The gradient of the potential: the unit vector `u = e / |e|` away from the goal; 0 at the goal.
    ///
    /// # Numerics
    /// `u` has length 1 for every offset except zero, including subnormal and huge offsets.
    #[inline]
    pub fn gradient(&self, position: &SVector<T, D>) -> SVector<T, D> {
        self.distance_and_gradient(position).1
    }

    /// [`distance`](Self::distance) and [`gradient`](Self::gradient) together, at the cost of one.
    #[inline]
    pub(crate) fn distance_and_gradient(&self, position: &SVector<T, D>) -> (T, SVector<T, D>) {
        polar_way(&self.goal, position)
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{Vector1, Vector2};

    use super::*;

    #[test]
    fn the_gradient_has_unit_length_at_every_distance() {
        let attractor = Attractor::new(Vector2::new(0.0_f32, 0.0)).unwrap();
        for size in [1e-45_f32, 1e-40, 1e-30, 1e-12, 1.0, 1e30, f32::MAX] {
            let (distance, direction) = attractor.distance_and_gradient(&Vector2::new(0.0, -size));
            assert_eq!((distance, direction), (size, Vector2::new(0.0, -1.0)));
        }
        // An offset that overflows still has a direction.
        let attractor = Attractor::new(Vector1::new(-f64::MAX)).unwrap();
        let (distance, direction) = attractor.distance_and_gradient(&Vector1::new(f64::MAX));
        assert_eq!((distance, direction), (f64::INFINITY, Vector1::new(1.0)));
    }
}
