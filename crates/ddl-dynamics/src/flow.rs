//! Flows: the velocity with which a walker is drawn to its goal.

use nalgebra::SVector;

use crate::{
    attractor::Attractor, error::DynamicsError, metric_source::MetricSource, real::Real,
    state::State,
};

/// A velocity field with one attractor.
///
/// What a flow promises is that, in continuous time, the distance to the goal of its
/// [`attractor`](Self::attractor) falls along it; each implementation says at which rate. What is
/// left of the promise in steps of finite length is the [`Integrator`](crate::Integrator)'s part.
pub trait Flow<T: Real, const D: usize> {
    /// The attractor that the flow descends.
    fn attractor(&self) -> &Attractor<T, D>;

    /// The velocity at `state` (m/s); zero at the goal.
    ///
    /// # Errors
    /// Whatever keeps the flow from giving a velocity, see the implementation.
    fn velocity(&self, state: &State<'_, T, D>) -> Result<SVector<T, D>, DynamicsError>;
}

/// Gradient descent on the distance: `v = -grad Phi`, straight to the goal at 1 m/s.
///
/// The distance falls at the rate 1, so the goal is reached after `Phi(p(0))` seconds.
///
/// # References
/// Equation (8) of the paper.
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

    fn velocity(&self, state: &State<'_, T, D>) -> Result<SVector<T, D>, DynamicsError> {
        Ok(-self.attractor.gradient(&state.position))
    }
}

/// Natural gradient descent on the distance: `v = -P grad Phi`, `P = L L^T + sigma I`.
///
/// The distance falls at the rate `u^T P u`, at least the smallest eigenvalue of `P` and so at
/// least `sigma`, whatever metric the source gives at whatever state: the goal is reached after at
/// most `Phi(p(0)) / lambda_min` seconds, with `lambda_min` the smallest eigenvalue along the path.
/// The velocity is less than 90 degrees away from the direction to the goal.
///
/// # References
/// Equation (9) of the paper, with `P` of equation (11).
///
/// # Examples
/// ```
/// use ddl_dynamics::{Attractor, CholeskyMetric, Flow, NaturalGradientFlow, State};
/// use nalgebra::Vector2;
///
/// let metric = CholeskyMetric::planar(1.0, 0.5, 0.75, 0.25)?; // P = [1.25 0.5; 0.5 1.0625]
/// let flow = NaturalGradientFlow::new(Attractor::new(Vector2::zeros())?, metric);
/// let velocity = flow.velocity(&State::at(Vector2::new(2.0, 0.0)))?;
/// assert_eq!(velocity, Vector2::new(-1.25, -0.5));
/// # Ok::<(), ddl_dynamics::DynamicsError>(())
/// ```
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

    /// Where the metrics come from.
    pub fn source(&self) -> &M {
        &self.source
    }
}

impl<T: Real, const D: usize, M: MetricSource<T, D>> Flow<T, D> for NaturalGradientFlow<T, D, M> {
    fn attractor(&self) -> &Attractor<T, D> {
        &self.attractor
    }

    /// # Errors
    /// Those of the metric source.
    fn velocity(&self, state: &State<'_, T, D>) -> Result<SVector<T, D>, DynamicsError> {
        let metric = self.source.metric(state)?;
        Ok(-metric.apply(&self.attractor.gradient(&state.position)))
    }
}
