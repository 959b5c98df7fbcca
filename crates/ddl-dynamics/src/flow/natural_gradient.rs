//! Natural gradient descent to the goal, shaped by a metric.

use super::Flow;
use crate::{
    attractor::Attractor, error::DynamicsError, metric::CholeskyMetric, metric_source::MetricSource, real::Real,
    state::State,
};

/// Natural gradient descent: `v = -P grad Phi`, `P = L L^T + sigma I`.
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
}

impl<T: Real, const D: usize, M: MetricSource<T, D>> Flow<T, D> for NaturalGradientFlow<T, D, M> {
    fn attractor(&self) -> &Attractor<T, D> {
        &self.attractor
    }

    fn metric(&self, state: &State<T, D>) -> Result<CholeskyMetric<T, D>, DynamicsError> {
        self.source.metric(state)
    }
}
