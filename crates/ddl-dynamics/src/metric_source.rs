//! Where the metric of a step comes from: a constant, a schedule, or a function of the state.

use crate::{error::DynamicsError, metric::CholeskyMetric, real::Real, state::State};

/// Gives the metric `P(p(t))` at a state.
///
/// Implemented by a [`CholeskyMetric`] (the same everywhere), by a [`MetricSchedule`] (one per
/// step, as a network emits them) and by every closure of the state:
///
/// ```
/// use ddl_dynamics::{CholeskyMetric, MetricSource, State};
/// use nalgebra::Vector2;
///
/// // Slows down within the first second.
/// let source = |state: &State<'_, f64, 2>| {
///     CholeskyMetric::planar(1.4 - 0.4 * state.time.min(1.0), 0.2, 0.9, 1e-8)
/// };
/// let metric = source.metric(&State::at(Vector2::new(3.0, 0.0)))?;
/// assert_eq!(metric.factor().m11, 1.4);
/// # Ok::<(), ddl_dynamics::DynamicsError>(())
/// ```
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
