//! Flows: the velocity with which a pedestrian approaches its goal.

use crate::{
    attractor::Attractor, error::DynamicsError, metric::CholeskyMetric, metric_source::MetricSource, real::Real,
    state::State,
};
use nalgebra::SVector;

/// Natural gradient descent to the goal of an [attractor](Self::attractor) `Phi`, stable by construction:
///
/// ```text
/// v = -P grad Phi, P = L L^T + sigma I,      so      d Phi / dt = -(grad Phi)^T P grad Phi < 0 away from the goal
/// ```
///
/// for every dependence of the [metric](Self::metric) `P` on the state. The [`Integrator`](crate::Integrator) has to
/// preserve this in steps of finite length.
///
/// The distance falls at the rate `u^T P u`, at least the smallest eigenvalue of `P`, for every metric at every state.
/// So the goal is reached after at most `Phi(p(0)) / lambda_min` seconds. The velocity is less than 90 degrees away
/// from the direction to the goal.
///
/// # References
/// Equation (9) of the paper, with `P` of equation (11); with [`CholeskyMetric::identity`] it is equation (8).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NaturalGradientFlow<T, const D: usize, M> {
    attractor: Attractor<T, D>,
    source: M,
}

impl<T: Real, const D: usize, M: MetricSource<T, D>> NaturalGradientFlow<T, D, M> {
    /// The flow to the goal of `attractor`, shaped by the metrics of `source`.
    pub fn new(attractor: Attractor<T, D>, source: M) -> Self {
        Self { attractor, source }
    }

    /// The attractor that the flow descends.
    pub fn attractor(&self) -> &Attractor<T, D> {
        &self.attractor
    }

    /// The metric `P` at `state`.
    ///
    /// # Errors
    /// If the source cannot determine a metric; see its implementation.
    pub fn metric(&self, state: &State<T, D>) -> Result<CholeskyMetric<T, D>, DynamicsError> {
        self.source.metric(state)
    }

    /// The velocity of the pedestrian at `state` (m/s): `-P grad Phi`.
    ///
    /// # Errors
    /// Those of [`metric`](Self::metric).
    pub fn velocity(&self, state: &State<T, D>) -> Result<SVector<T, D>, DynamicsError> {
        let metric = self.metric(state)?;
        Ok(-metric.apply(&self.attractor.gradient(&state.position)))
    }
}
