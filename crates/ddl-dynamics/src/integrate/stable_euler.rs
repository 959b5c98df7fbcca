//! Euler steps that keep the stability guarantee.

use super::Integrator;
use crate::{
    attractor::Attractor,
    error::{DynamicsError, ensure_finite, ensure_time_step},
    flow::NaturalGradientFlow,
    metric_source::MetricSource,
    polar::polar,
    real::Real,
    state::State,
};
use nalgebra::SVector;

/// A step to the closest point that ends within this many rounding errors of the goal is moved onto the goal, because
/// the rest is rounding.
const ARRIVAL: f64 = 8.0;

/// Euler steps that end, at the latest, at the point of the line of motion closest to the goal.
///
/// ```text
/// p' = p + min(dt, dt*) v        dt* = |e| u^T P u / |P u|^2
/// ```
///
/// with `e = p - p*`, `u = e / |e|`, `v = -P u`. While `dt <= dt*` this is exactly the plain Euler step; at the goal
/// the pedestrian stays.
///
/// # What is guaranteed
/// - *Strict decrease, for every `dt > 0`*: with `h = min(dt, dt*)`, `Phi' <= Phi - h u^T P u / 2 < Phi`.
/// - *Convergence in a bounded number of steps*, if the eigenvalues of the metrics stay in `[m, M]`, `m > 0`: with `r =
///   (M - m) / (M + m)`, `Phi <= tolerance` after at most `2 Phi(0) / (dt m) + ln(Phi(0) / tolerance) / ln(1 / r)`
///   steps, rounded up one by one.
///
/// The proofs are Theorems 3 and 4 of `PROOFS.md`.
///
/// # Numerics
/// The guarantee holds for the *computed* distance, [`Attractor::distance`], in `f32` as in `f64`: every step strictly
/// lowers it until it is 0, for every finite input. Where rounding could break the decrease,
/// - a limited step that ends within `8 epsilon max(|p|, |p*|)` of the goal puts the pedestrian on the goal;
/// - a decrease too small to be seen in `T`, or a computed velocity that does not approach the goal (see
///   [`apply`](crate::CholeskyMetric::apply)), is replaced by the smallest move straight to the goal that changes the
///   distance: about `epsilon max(|p|, |p*|)`, doubled until it does.
///
/// So every computed rollout ends on the goal after enough steps.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash)]
pub struct StableEuler;

impl StableEuler {
    /// The position after one step from `position` (metres) with `velocity` (m/s) for at most `dt` (seconds).
    ///
    /// # Errors
    /// [`DynamicsError::NotPositive`] for the time step; [`DynamicsError::NonFinite`] for the position or the velocity;
    /// [`DynamicsError::DistanceTooLarge`] if the distance to the goal overflows.
    #[inline]
    pub fn advance<T: Real, const D: usize>(
        attractor: &Attractor<T, D>,
        position: &SVector<T, D>,
        velocity: &SVector<T, D>,
        dt: T,
    ) -> Result<SVector<T, D>, DynamicsError> {
        ensure_time_step(dt)?;
        ensure_finite("position", position)?;
        ensure_finite("velocity", velocity)?;
        let (distance, away) = attractor.distance_and_gradient(position);
        if !distance.is_finite() {
            return Err(DynamicsError::DistanceTooLarge);
        }
        if distance.is_zero() {
            return Ok(*position);
        }
        // Spacing of floating-point numbers at the coarser of the two points; never 0, so that doubling works.
        let resolution = (T::EPSILON * position.amax().max(attractor.goal().amax())).max(T::MIN_POSITIVE);

        let (speed, heading) = polar(velocity);
        let cosine = -away.dot(&heading);
        if cosine > T::zero() {
            let reach = distance * cosine;
            let full = dt * speed <= reach;
            let next = if full { position + velocity * dt } else { position + heading * reach };
            let left = attractor.distance(&next);
            if !full && left <= T::rounded(ARRIVAL) * resolution {
                return Ok(*attractor.goal());
            }
            if left < distance {
                return Ok(next);
            }
        }
        // The shortest of the moves `resolution * 2^k` straight to the goal that lowers the computed distance, or the
        // goal. There are few doublings, because the distance is at most `2 sqrt(D) resolution / epsilon`.
        let mut length = resolution;
        while length < distance {
            let next = position - away * length;
            if attractor.distance(&next) < distance {
                return Ok(next);
            }
            length += length;
        }
        Ok(*attractor.goal())
    }
}

impl<T: Real, const D: usize> Integrator<T, D> for StableEuler {
    fn step<M: MetricSource<T, D>>(
        &self,
        flow: &NaturalGradientFlow<T, D, M>,
        state: &State<T, D>,
        dt: T,
    ) -> Result<SVector<T, D>, DynamicsError> {
        let velocity = flow.velocity(state)?;
        Self::advance(flow.attractor(), &state.position, &velocity, dt)
    }
}
