//! Straight to the goal.

use nalgebra::SVector;

use super::Flow;
use crate::{
    attractor::Attractor, error::DynamicsError, metric::CholeskyMetric, real::Real, state::State,
};

/// Gradient descent: `v = -grad Phi`, straight to the goal.
///
/// On a distance the walker moves at 1 m/s and is there after `Phi(p(0))` seconds. On a quadratic
/// attractor it moves at `|e|` per second and nears the goal as `exp(-t)`.
///
/// # References
/// Equation (8) of the paper.
///
/// # Examples
/// ```
/// use ddl_dynamics::{Attractor, Flow, GradientFlow, State};
/// use nalgebra::Vector2;
///
/// let flow = GradientFlow::new(Attractor::new(Vector2::new(3.0, 4.0))?);
/// let velocity = flow.velocity(&State::at(Vector2::zeros()))?;
/// assert!((velocity - Vector2::new(0.6, 0.8)).norm() < 1e-12); // 1 m/s, straight there
/// # Ok::<(), ddl_dynamics::DynamicsError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GradientFlow<T, const D: usize> {
    attractor: Attractor<T, D>,
}

impl<T: Real, const D: usize> GradientFlow<T, D> {
    /// The flow straight to the goal of `attractor`.
    pub fn new(attractor: Attractor<T, D>) -> Self {
        Self { attractor }
    }
}

impl<T: Real, const D: usize> Flow<T, D> for GradientFlow<T, D> {
    fn attractor(&self) -> &Attractor<T, D> {
        &self.attractor
    }

    /// The identity, exactly.
    fn metric(&self, _state: &State<'_, T, D>) -> Result<CholeskyMetric<T, D>, DynamicsError> {
        Ok(CholeskyMetric::identity())
    }

    fn velocity(&self, state: &State<'_, T, D>) -> Result<SVector<T, D>, DynamicsError> {
        Ok(-self.attractor.gradient(&state.position))
    }
}
