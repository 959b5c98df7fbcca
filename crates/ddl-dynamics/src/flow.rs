//! Flows: the velocity with which a pedestrian approaches its goal.

mod natural_gradient;

use nalgebra::SVector;

use crate::{attractor::Attractor, error::DynamicsError, metric::CholeskyMetric, real::Real, state::State};

pub use natural_gradient::NaturalGradientFlow;

/// A velocity field with one attractor, stable by construction.
///
/// A flow has an [`attractor`](Self::attractor) `Phi` and a positive-definite [`metric`](Self::metric) `P` at every
/// state. Its motion is
///
/// ```text
/// dp/dt = -P grad Phi(p),      so      d Phi / dt = -(grad Phi)^T P grad Phi < 0 away from the goal
/// ```
///
/// for every dependence of `P` on the state. The [`Integrator`](crate::Integrator) has to preserve this in steps of
/// finite length.
pub trait Flow<T: Real, const D: usize> {
    /// The attractor that the flow descends.
    fn attractor(&self) -> &Attractor<T, D>;

    /// The metric `P` at `state`.
    ///
    /// # Errors
    /// If the flow cannot determine a metric; see the implementation.
    fn metric(&self, state: &State<T, D>) -> Result<CholeskyMetric<T, D>, DynamicsError>;

    /// The velocity of the pedestrian at `state` (m/s): `-P grad Phi`.
    ///
    /// # Errors
    /// Those of [`metric`](Self::metric).
    fn velocity(&self, state: &State<T, D>) -> Result<SVector<T, D>, DynamicsError> {
        let metric = self.metric(state)?;
        Ok(-metric.apply(&self.attractor().gradient(&state.position)))
    }
}
