//! Integrators: from a velocity field to a sequence of positions.

mod euler;
mod stable_euler;

use crate::{error::DynamicsError, flow::NaturalGradientFlow, metric_source::MetricSource, real::Real, state::State};
use nalgebra::SVector;

pub use euler::Euler;
pub use stable_euler::StableEuler;

/// An integration rule for one time step.
pub trait Integrator<T: Real, const D: usize> {
    /// The position `dt` seconds after `state` (metres).
    ///
    /// # Errors
    /// Those of the flow; [`DynamicsError::NotPositive`] unless `dt` is positive and finite;
    /// [`DynamicsError::NonFinite`] when the position, the velocity or the result is not finite.
    fn step<M: MetricSource<T, D>>(
        &self,
        flow: &NaturalGradientFlow<T, D, M>,
        state: &State<T, D>,
        dt: T,
    ) -> Result<SVector<T, D>, DynamicsError>;
}
