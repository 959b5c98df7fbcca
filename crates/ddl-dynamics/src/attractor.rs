//! The attractor: a potential with its minimum at the goal, and its gradient.

use nalgebra::SVector;

use crate::{
    error::{DynamicsError, ensure_finite},
    polar::polar_way,
    real::Real,
};

/// A potential with its only minimum at a goal `p*`; every flow of this crate descends it.
///
/// | | `Phi(p)` | `grad Phi` | a flow down it |
/// |---|---|---|---|
/// | [`new`](Self::new) | `\|e\|` | `u = e / \|e\|` | keeps its speed and arrives in finite time |
/// | [`quadratic`](Self::quadratic) | `\|e\|^2 / 2` | `e` | slows down near the goal and approaches it exponentially |
///
/// with `e = p - p*`. Both depend only on the distance and increase with it, so one falls exactly when the other does.
///
/// # Shapes
/// `D` components, in metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Attractor<T, const D: usize> {
    goal: SVector<T, D>,
    growth: Growth,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Growth {
    Linear,
    Quadratic,
}

impl<T: Real, const D: usize> Attractor<T, D> {
    /// The distance to `goal` (metres): `Phi(p) = |p - p*|`.
    ///
    /// # Errors
    /// [`DynamicsError::NonFinite`] if a component of the goal is NaN or infinite.
    pub fn new(goal: SVector<T, D>) -> Result<Self, DynamicsError> {
        Self::growing(goal, Growth::Linear)
    }

    /// Half the squared distance to `goal` (metres): `Phi(p) = |p - p*|^2 / 2`.
    ///
    /// Its gradient is in metres, so the entries of a metric `P` are rates (1/s).
    ///
    /// # Errors
    /// [`DynamicsError::NonFinite`] if a component of the goal is NaN or infinite.
    pub fn quadratic(goal: SVector<T, D>) -> Result<Self, DynamicsError> {
        Self::growing(goal, Growth::Quadratic)
    }

    fn growing(goal: SVector<T, D>, growth: Growth) -> Result<Self, DynamicsError> {
        ensure_finite("goal", &goal)?;
        Ok(Self { goal, growth })
    }

    /// The goal `p*` (metres).
    pub fn goal(&self) -> &SVector<T, D> {
        &self.goal
    }

    /// The offset from the goal, `e = p - p*` (metres).
    #[inline]
    pub fn offset(&self, position: &SVector<T, D>) -> SVector<T, D> {
        position - self.goal
    }

    /// The distance to the goal, `|p - p*|` (metres).
    ///
    /// # Numerics
    /// Zero only if `position` equals the goal component by component; squares that underflow or overflow are handled.
    /// A distance above the largest number of `T` is infinite.
    #[inline]
    pub fn distance(&self, position: &SVector<T, D>) -> T {
        self.distance_and_direction(position).0
    }

    /// The potential `Phi(p)` (metres; square metres when quadratic).
    ///
    /// # Numerics
    /// The square underflows to 0 within 1e-162 m of the goal (1e-23 m in `f32`); near the goal use
    /// [`distance`](Self::distance).
    #[inline]
    pub fn potential(&self, position: &SVector<T, D>) -> T {
        self.potential_and_gradient(position).0
    }

    /// The gradient of the potential: the unit vector `u = e / |e|` away from the goal, or the offset `e` if quadratic;
    /// 0 at the goal.
    ///
    /// # Numerics
    /// `u` has length 1 for every offset except zero, including subnormal and huge offsets.
    #[inline]
    pub fn gradient(&self, position: &SVector<T, D>) -> SVector<T, D> {
        self.potential_and_gradient(position).1
    }

    /// [`potential`](Self::potential) and [`gradient`](Self::gradient) together, at the cost of one.
    #[inline]
    pub fn potential_and_gradient(&self, position: &SVector<T, D>) -> (T, SVector<T, D>) {
        let (distance, away) = self.distance_and_direction(position);
        match self.growth {
            Growth::Linear => (distance, away),
            Growth::Quadratic => (distance * distance * T::rounded(0.5), self.offset(position)),
        }
    }

    /// The distance to the goal (metres) and the unit vector `u` away from it (0 at the goal), for either kind of
    /// potential.
    #[inline]
    pub fn distance_and_direction(&self, position: &SVector<T, D>) -> (T, SVector<T, D>) {
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
            let (distance, direction) = attractor.potential_and_gradient(&Vector2::new(0.0, -size));
            assert_eq!((distance, direction), (size, Vector2::new(0.0, -1.0)));
        }
        // An offset that overflows still has a direction.
        let attractor = Attractor::new(Vector1::new(-f64::MAX)).unwrap();
        let (distance, direction) = attractor.potential_and_gradient(&Vector1::new(f64::MAX));
        assert_eq!((distance, direction), (f64::INFINITY, Vector1::new(1.0)));
    }

    #[test]
    #[expect(clippy::float_cmp, reason = "small whole numbers are exact")]
    fn the_quadratic_potential_is_half_the_square() {
        let bowl = Attractor::quadratic(Vector2::new(1.0_f64, 1.0)).unwrap();
        let position = Vector2::new(4.0, 5.0);
        assert_eq!(bowl.potential_and_gradient(&position), (12.5, Vector2::new(3.0, 4.0)));
        assert_eq!(bowl.distance(&position), 5.0);
        assert_eq!(bowl.gradient(bowl.goal()), Vector2::zeros());
        // The square underflows, but the distance does not.
        let near = Vector2::new(1.0 + f64::EPSILON, 1.0);
        assert_eq!(bowl.distance(&near), f64::EPSILON);
    }
}
