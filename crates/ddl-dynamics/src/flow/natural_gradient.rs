//! Natural gradient descent to the goal, shaped by a metric.

use nalgebra::SVector;

use super::Flow;
use crate::{
    attractor::Attractor, error::DynamicsError, metric::CholeskyMetric, metric_source::MetricSource, real::Real,
    state::State,
};

/// Natural gradient descent: `v = -P grad Phi`, `P = L L^T + sigma I`.
///
/// The distance falls at the rate `u^T P u`, at least the smallest eigenvalue of `P`, for every metric at every state.
/// So the goal is reached after at most `Phi(p(0)) / lambda_min` seconds. For a quadratic attractor,
/// `|e(t)| <= |e(0)| exp(-lambda_min t)`. The velocity is less than 90 degrees away from the direction to the goal.
///
/// # References
/// Equation (9) of the paper, with `P` of equation (11); equation (8) is [`straight`](NaturalGradientFlow::straight).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NaturalGradientFlow<T, const D: usize, M> {
    attractor: Attractor<T, D>,
    source: M,
}

impl<T: Real, const D: usize> NaturalGradientFlow<T, D, CholeskyMetric<T, D>> {
    /// Gradient descent, `v = -grad Phi`: `P` is the identity, so the motion is straight to the goal. If `Phi` is the
    /// distance, the speed is 1 m/s.
    pub fn straight(attractor: Attractor<T, D>) -> Self {
        Self::new(attractor, CholeskyMetric::identity())
    }
}

impl<T: Real, const D: usize, M: MetricSource<T, D>> NaturalGradientFlow<T, D, M> {
    /// The flow to the goal of `attractor`, shaped by the metrics of `source`.
    pub fn new(attractor: Attractor<T, D>, source: M) -> Self {
        Self { attractor, source }
    }

    /// The source of the metrics.
    pub fn source(&self) -> &M {
        &self.source
    }
}

impl<T: Real, const D: usize, M: MetricSource<T, D>> Flow<T, D> for NaturalGradientFlow<T, D, M> {
    fn attractor(&self) -> &Attractor<T, D> {
        &self.attractor
    }

    fn metric(&self, state: &State<'_, T, D>) -> Result<CholeskyMetric<T, D>, DynamicsError> {
        self.source.metric(state)
    }

    fn velocity(&self, state: &State<'_, T, D>) -> Result<SVector<T, D>, DynamicsError> {
        let metric = self.source.metric(state)?;
        Ok(-metric.apply(&self.attractor.gradient(&state.position)))
    }
}
