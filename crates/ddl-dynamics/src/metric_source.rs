//! Sources of the metric of a step: a constant, a schedule, or a function of the state.

use crate::{
    attractor::Attractor,
    error::DynamicsError,
    metric::CholeskyMetric,
    motion_bounds::{MotionBounds, StepTime},
    real::Real,
    state::State,
};

/// A source of the metric `P(p(t))` at a state.
///
/// Implemented by a [`CholeskyMetric`] (the same everywhere), by a [`MetricSchedule`] (one per step) and by every
/// closure of the state.
pub trait MetricSource<T: Real, const D: usize> {
    /// The metric at `state`.
    ///
    /// # Errors
    /// If the source cannot give a metric, for instance because a factor is not finite.
    fn metric(&self, state: &State<T, D>) -> Result<CholeskyMetric<T, D>, DynamicsError>;
}

impl<T: Real, const D: usize> MetricSource<T, D> for CholeskyMetric<T, D> {
    fn metric(&self, _state: &State<T, D>) -> Result<CholeskyMetric<T, D>, DynamicsError> {
        Ok(*self)
    }
}

impl<T, const D: usize, F> MetricSource<T, D> for F
where
    T: Real,
    F: Fn(&State<T, D>) -> Result<CholeskyMetric<T, D>, DynamicsError>,
{
    fn metric(&self, state: &State<T, D>) -> Result<CholeskyMetric<T, D>, DynamicsError> {
        self(state)
    }
}

/// One metric per step; the last one holds for all later steps.
#[derive(Debug, Clone, PartialEq)]
pub struct MetricSchedule<T, const D: usize> {
    metrics: Vec<CholeskyMetric<T, D>>,
}

impl<T: Real, const D: usize> MetricSchedule<T, D> {
    /// The schedule that uses `metrics[k]` in step `k`.
    ///
    /// # Errors
    /// [`DynamicsError::EmptySchedule`] if there is no metric.
    pub fn new(metrics: Vec<CholeskyMetric<T, D>>) -> Result<Self, DynamicsError> {
        if metrics.is_empty() {
            return Err(DynamicsError::EmptySchedule);
        }
        Ok(Self { metrics })
    }
}

impl<T: Real, const D: usize> MetricSource<T, D> for MetricSchedule<T, D> {
    fn metric(&self, state: &State<T, D>) -> Result<CholeskyMetric<T, D>, DynamicsError> {
        Ok(self.metrics[state.step.min(self.metrics.len() - 1)])
    }
}

/// One metric per step of `time_step` seconds, step `k` shaped by `metrics[k]` within the bounds of a motion that
/// arrives at its goal with the last step ([`MotionBounds::shape`]). The bounds depend on the current position.
///
/// # Errors
/// [`DynamicsError::EmptySchedule`] if there is no metric.
pub fn arriving_schedule<T: Real>(
    metrics: Vec<CholeskyMetric<T, 2>>,
    attractor: Attractor<T, 2>,
    bounds: MotionBounds<T>,
    time_step: T,
) -> Result<impl MetricSource<T, 2>, DynamicsError> {
    let schedule = MetricSchedule::new(metrics)?;
    Ok(move |state: &State<T, 2>| {
        let time =
            StepTime { done: state.step, left: schedule.metrics.len().saturating_sub(state.step), dt: time_step };
        let towards = attractor.goal() - state.position;
        Ok(bounds.shape(&schedule.metric(state)?, &towards, time))
    })
}
