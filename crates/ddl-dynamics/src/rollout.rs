//! Rollouts: a flow integrated for a number of steps.

use crate::{
    error::{DynamicsError, ensure_finite, ensure_time_step},
    flow::NaturalGradientFlow,
    integrate::Integrator,
    metric_source::MetricSource,
    real::Real,
    state::State,
};
use nalgebra::SVector;

/// Integrates `flow` from `start` for `steps` steps of `dt` seconds.
///
/// # Shapes
/// `steps + 1` positions in metres, `start` first.
///
/// # Errors
/// [`DynamicsError::NotPositive`] for `dt`, [`DynamicsError::NonFinite`] for the start, and [`DynamicsError::Step`]
/// with the step in which the flow or the integrator failed.
pub fn rollout<T, const D: usize, M, I>(
    flow: &NaturalGradientFlow<T, D, M>,
    integrator: &I,
    start: SVector<T, D>,
    dt: T,
    steps: usize,
) -> Result<Vec<SVector<T, D>>, DynamicsError>
where
    T: Real,
    M: MetricSource<T, D>,
    I: Integrator<T, D>,
{
    let mut positions = vec![SVector::zeros(); steps + 1];
    rollout_into(flow, integrator, start, dt, &mut positions)?;
    Ok(positions)
}

/// [`rollout`] into a slice: `positions[0]` becomes `start`, and each further element is one step;
/// an empty slice stays unchanged.
///
/// # Errors
/// Those of [`rollout`]; the positions before the failing step are then valid.
pub fn rollout_into<T, const D: usize, M, I>(
    flow: &NaturalGradientFlow<T, D, M>,
    integrator: &I,
    start: SVector<T, D>,
    dt: T,
    positions: &mut [SVector<T, D>],
) -> Result<(), DynamicsError>
where
    T: Real,
    M: MetricSource<T, D>,
    I: Integrator<T, D>,
{
    ensure_time_step(dt)?;
    ensure_finite("start", &start)?;
    if let Some(first) = positions.first_mut() {
        *first = start;
    }
    for next in 1..positions.len() {
        let step = next - 1;
        // Multiplied, not accumulated: 12 steps of 0.4 s end at exactly 4.8 s.
        let time = dt * T::rounded(step as f64);
        let state = State::new(positions[step], step, time);
        positions[next] =
            integrator.step(flow, &state, dt).map_err(|cause| DynamicsError::Step { step, cause: Box::new(cause) })?;
    }
    Ok(())
}
