//! Where the metric of a step comes from: a constant, a schedule, or a function of the state.

use crate::{
    attractor::Attractor,
    error::DynamicsError,
    metric::CholeskyMetric,
    motion_bounds::{MotionBounds, StepTime},
    real::Real,
    state::State,
};

/// Gives the metric `P(p(t))` at a state.
///
/// Implemented by a [`CholeskyMetric`] (the same everywhere), by a [`MetricSchedule`] (one per step) and by every
/// closure of the state.
pub trait MetricSource<T: Real, const D: usize> {
    /// The metric at `state`.
    ///
    /// # Errors
    /// Whatever keeps the source from giving a metric, for instance a factor that is not finite.
    fn metric(&self, state: &State<'_, T, D>) -> Result<CholeskyMetric<T, D>, DynamicsError>;
}

impl<T: Real, const D: usize> MetricSource<T, D> for CholeskyMetric<T, D> {
    fn metric(&self, _state: &State<'_, T, D>) -> Result<CholeskyMetric<T, D>, DynamicsError> {
        Ok(*self)
    }
}

impl<T, const D: usize, F> MetricSource<T, D> for F
where
    T: Real,
    F: Fn(&State<'_, T, D>) -> Result<CholeskyMetric<T, D>, DynamicsError>,
{
    fn metric(&self, state: &State<'_, T, D>) -> Result<CholeskyMetric<T, D>, DynamicsError> {
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
    /// [`DynamicsError::EmptySchedule`] when there is no metric.
    pub fn new(metrics: Vec<CholeskyMetric<T, D>>) -> Result<Self, DynamicsError> {
        if metrics.is_empty() {
            return Err(DynamicsError::EmptySchedule);
        }
        Ok(Self { metrics })
    }

    /// The metrics, one per step; never empty.
    pub fn metrics(&self) -> &[CholeskyMetric<T, D>] {
        &self.metrics
    }
}

impl<T: Real, const D: usize> MetricSource<T, D> for MetricSchedule<T, D> {
    fn metric(&self, state: &State<'_, T, D>) -> Result<CholeskyMetric<T, D>, DynamicsError> {
        let last = self.metrics.len() - 1;
        Ok(self.metrics[state.step.min(last)])
    }
}

/// One metric per step, each brought within the bounds of a motion that arrives at its goal with the last of
/// them ([`MotionBounds::shape`]). What the bounds are depends on where the pedestrian is by then.
///
/// # Examples
/// ```
/// use ddl_dynamics::{
///     ArrivingSchedule, Attractor, CholeskyMetric, MotionBounds, NaturalGradientFlow, StableEuler, rollout,
/// };
/// use nalgebra::Vector2;
///
/// // Far too fast, and askew: 9 m/s and more for somebody who has 4 m to go in 4.8 s.
/// let metrics = vec![CholeskyMetric::planar(3.0, 2.0, 4.0, 1e-8)?; 12];
/// let goal = Attractor::new(Vector2::new(4.0, 0.0))?;
/// let bounds = MotionBounds::new(2.0, Vector2::zeros(), 1.0).expect("numbers in range");
/// let schedule = ArrivingSchedule::new(metrics, goal, bounds, 0.4)?;
/// let flow = NaturalGradientFlow::new(goal, schedule);
/// let path = rollout(&flow, &StableEuler, Vector2::zeros(), 0.4, 12)?;
/// assert!(path.windows(2).all(|step| (step[1] - step[0]).norm() <= 0.4 * 2.0 + 1e-12));
/// assert!((path[12] - goal.goal()).norm() < 1e-12);
/// # Ok::<(), ddl_dynamics::DynamicsError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct ArrivingSchedule<T: Real> {
    metrics: MetricSchedule<T, 2>,
    attractor: Attractor<T, 2>,
    bounds: MotionBounds<T>,
    time_step: T,
}

impl<T: Real> ArrivingSchedule<T> {
    /// The schedule that shapes step `k` by `metrics[k]` within `bounds`, and arrives after the last one.
    /// Steps take `time_step` seconds.
    ///
    /// # Errors
    /// [`DynamicsError::EmptySchedule`] when there is no metric.
    pub fn new(
        metrics: Vec<CholeskyMetric<T, 2>>,
        attractor: Attractor<T, 2>,
        bounds: MotionBounds<T>,
        time_step: T,
    ) -> Result<Self, DynamicsError> {
        Ok(Self {
            metrics: MetricSchedule::new(metrics)?,
            attractor,
            bounds,
            time_step,
        })
    }

    /// The bounds of the motion.
    pub fn bounds(&self) -> &MotionBounds<T> {
        &self.bounds
    }
}

impl<T: Real> MetricSource<T, 2> for ArrivingSchedule<T> {
    fn metric(&self, state: &State<'_, T, 2>) -> Result<CholeskyMetric<T, 2>, DynamicsError> {
        let metric = self.metrics.metric(state)?;
        let time = StepTime {
            done: state.step,
            left: self.metrics.metrics().len().saturating_sub(state.step),
            dt: self.time_step,
        };
        let towards = self.attractor.goal() - state.position;
        Ok(self.bounds.shape(&metric, &towards, time))
    }
}
