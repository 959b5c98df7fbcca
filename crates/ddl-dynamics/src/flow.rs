//! Flows: the velocity with which a pedestrian approaches its goal.

mod avoiding;
mod diffeomorphic;
mod natural_gradient;

use nalgebra::SVector;

use crate::{
    attractor::Attractor, diffeomorphism::Diffeomorphism, error::DynamicsError, metric::CholeskyMetric, real::Real,
    state::State,
};

pub use avoiding::AvoidingFlow;
pub use diffeomorphic::DiffeomorphicFlow;
pub use natural_gradient::NaturalGradientFlow;

/// A velocity field with one attractor, stable by construction.
///
/// A flow has an [`attractor`](Self::attractor) `Phi`, a positive-definite [`metric`](Self::metric) `P` at every state
/// and, optionally, a [`chart`](Self::chart) `psi`. With `y = psi(p)` (`y = p` without a chart) its motion is
///
/// ```text
/// dy/dt = -P grad Phi(y),      so      d Phi / dt = -(grad Phi)^T P grad Phi < 0 away from the goal
/// ```
///
/// for every dependence of `P` on the state. The [`Integrator`](crate::Integrator) has to preserve this in steps of
/// finite length.
pub trait Flow<T: Real, const D: usize> {
    /// The attractor that the flow descends, in the coordinates of the [`chart`](Self::chart).
    fn attractor(&self) -> &Attractor<T, D>;

    /// The goal in space (metres); with a chart, the [`attractor`](Self::attractor) is at its image.
    fn goal(&self) -> &SVector<T, D> {
        self.attractor().goal()
    }

    /// The metric `P` at `state`, in the coordinates of the [`chart`](Self::chart).
    ///
    /// # Errors
    /// If the flow cannot determine a metric; see the implementation.
    fn metric(&self, state: &State<'_, T, D>) -> Result<CholeskyMetric<T, D>, DynamicsError>;

    /// The velocity of the pedestrian at `state` (m/s): `-P grad Phi`, transformed to space if there is a chart. It
    /// must agree with [`metric`](Self::metric), because integrators use either.
    ///
    /// # Errors
    /// Those of [`metric`](Self::metric).
    fn velocity(&self, state: &State<'_, T, D>) -> Result<SVector<T, D>, DynamicsError>;

    /// The coordinates in which the potential is a plain distance; `None` if these are the coordinates of space.
    fn chart(&self) -> Option<&dyn Diffeomorphism<T, D>> {
        None
    }

    /// The longest time for which `velocity` (m/s) may be followed from `state` (seconds, positive); `None` if the flow
    /// sets no limit. [`StableEuler`](crate::StableEuler) ignores it for flows with a [`chart`](Self::chart), because
    /// its steps are straight in the chart.
    fn longest_step(&self, state: &State<'_, T, D>, velocity: &SVector<T, D>) -> Option<T> {
        let _ = (state, velocity);
        None
    }
}
