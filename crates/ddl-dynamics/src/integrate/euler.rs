//! The published scheme: plain Euler steps.

use super::Integrator;
use crate::{
    error::{DynamicsError, ensure_finite, ensure_time_step},
    flow::NaturalGradientFlow,
    metric_source::MetricSource,
    real::Real,
    state::State,
};
use nalgebra::SVector;

/// The plain Euler step `p' = p + dt v`: the published scheme, kept for reproduction.
///
/// # What is guaranteed
/// There is no general guarantee. With `e = p - p*`, `u = e / |e|` and `v = -P u`, the distance to the goal falls in a
/// step exactly when `dt < 2 |e| u^T P u / |P u|^2` (Proposition 2 of `PROOFS.md`). For the distance potential this
/// fails close to the goal for every fixed `dt`: the pedestrian oscillates around the goal.
/// [`StableEuler`](super::StableEuler) keeps the guarantee.
///
/// # References
/// Equation (2) of the paper, with a step of 0.4 s in the published program.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash)]
pub struct Euler;

impl<T: Real, const D: usize> Integrator<T, D> for Euler {
    fn step<M: MetricSource<T, D>>(
        &self,
        flow: &NaturalGradientFlow<T, D, M>,
        state: &State<T, D>,
        dt: T,
    ) -> Result<SVector<T, D>, DynamicsError> {
        ensure_time_step(dt)?;
        ensure_finite("position", &state.position)?;
        let velocity = flow.velocity(state)?;
        ensure_finite("velocity", &velocity)?;
        let next = state.position + velocity * dt;
        ensure_finite("next position", &next)?;
        Ok(next)
    }
}
