//! A walker 4 m from its goal, and a metric that leans to one side of the way there.

use ddl_dynamics::{
    Attractor, CholeskyMetric, DynamicsError, Integrator, LyapunovCertificate, NaturalGradientFlow,
    PUBLISHED_SIGMA, rollout,
};
use nalgebra::Vector2;

/// Seconds of a step, those of the published program.
pub(crate) const TIME_STEP: f64 = 0.4;
/// Steps followed.
pub(crate) const STEPS: usize = 24;

/// What both walks have in common.
pub(crate) struct Scene {
    pub(crate) start: Vector2<f64>,
    pub(crate) attractor: Attractor<f64, 2>,
    pub(crate) metric: CholeskyMetric<f64, 2>,
}

/// A path from the start, and what its certificate says.
pub(crate) struct Walk {
    /// The start and 24 further positions (metres).
    pub(crate) path: Vec<Vector2<f64>>,
    pub(crate) certificate: LyapunovCertificate<f64>,
}

impl Scene {
    /// Walking pace: 1.3 m/s at the start, and 0.8 to 1.7 m/s wherever the goal lies.
    pub(crate) fn new() -> Result<Self, DynamicsError> {
        Ok(Self {
            start: Vector2::zeros(),
            attractor: Attractor::new(Vector2::new(4.0, 0.0))?,
            metric: CholeskyMetric::planar(1.1, 0.4, 1.1, PUBLISHED_SIGMA)?,
        })
    }

    /// The walk that `integrator` makes of the flow.
    pub(crate) fn follow(
        &self,
        integrator: &impl Integrator<f64, 2>,
    ) -> Result<Walk, DynamicsError> {
        let flow = NaturalGradientFlow::new(self.attractor, self.metric);
        let path = rollout(&flow, integrator, self.start, TIME_STEP, STEPS)?;
        let metrics = [self.metric; STEPS];
        let certificate = LyapunovCertificate::new(&path, &metrics, &self.attractor, TIME_STEP)?;
        Ok(Walk { path, certificate })
    }

    /// How close to the goal a plain Euler step no longer approaches it, on the side of the unit vector
    /// `away` (metres): `dt < 2 Phi u^T P u / |P u|^2` solved for `Phi`,
    ///
    /// ```text
    /// Phi <= dt |P u|^2 / (2 u^T P u)
    /// ```
    pub(crate) fn overshoot_radius(&self, away: &Vector2<f64>) -> f64 {
        let speed = self.metric.apply(away).norm();
        TIME_STEP * speed * speed / (2.0 * self.metric.quadratic_form(away))
    }
}
