//! The walk of a forecast in `f64`, with the certificate of every hypothesis.

use crate::Result;
use ddl::data::{HORIZON, OBSERVED, Position, Window};
use ddl::dynamics::{
    Attractor, CholeskyMetric, LyapunovCertificate, MetricSchedule, NaturalGradientFlow,
    StableEuler, rollout,
};
use ddl::network::{StarConfig, WindowRollout};
use nalgebra::Vector2;

pub(crate) fn all(
    star: &StarConfig,
    window: &Window,
    goals: &[Vec<Position>],
    shaped: &WindowRollout,
) -> Result<()> {
    let factors = shaped.factors.as_ref().ok_or("no dynamics")?;
    let hypotheses = factors.chunks_exact(HORIZON).zip(goals.iter().flatten());
    for (pair, (factors, &goal)) in hypotheses.enumerate() {
        let metric = |&[a, b, c]: &[f64; 3]| CholeskyMetric::planar(a, b, c, star.sigma);
        let metrics = factors
            .iter()
            .map(metric)
            .collect::<std::result::Result<_, _>>()?;
        let attractor = Attractor::new(Vector2::from(goal))?;
        let flow = NaturalGradientFlow::new(attractor, MetricSchedule::new(metrics)?);
        let start = window.observed(pair / shaped.hypotheses)[OBSERVED - 1];
        let path = rollout(&flow, &StableEuler, start.into(), star.time_step, HORIZON)?;
        LyapunovCertificate::of_rollout(&flow, &path, star.time_step)?.holds()?;
    }
    Ok(())
}
