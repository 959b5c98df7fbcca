//! Euler steps that keep the stability guarantee.

use nalgebra::SVector;
use serde::{Deserialize, Serialize};

use super::Integrator;
use crate::{
    attractor::Attractor,
    error::{DynamicsError, ensure_finite, ensure_time_step},
    flow::Flow,
    polar::polar,
    real::Real,
    state::State,
};

/// A step to the closest point that ends within this many rounding errors of the goal is moved onto the goal, because
/// the rest is rounding.
const ARRIVAL: f64 = 8.0;

/// Euler steps that end, at the latest, at the point of the line of motion closest to the goal.
///
/// ```text
/// p' = p + min(dt, dt*) v        dt* = |e| u^T P u / |P u|^2
/// ```
///
/// with `e = p - p*`, `u = e / |e|`, `v = -P u` (on a quadratic attractor `v = -P e`: read `|e| P` for `P` below).
/// While `dt <= dt*` this is exactly the plain Euler step; at the goal the pedestrian stays.
///
/// # What is guaranteed
/// - *Strict decrease, for every `dt > 0`*: with `h = min(dt, dt*)`, `Phi' <= Phi - h u^T P u / 2 < Phi`.
/// - *Convergence in a bounded number of steps* for the distance potential, if the eigenvalues of the metrics stay in
///   `[m, M]`, `m > 0`: with `r = (M - m) / (M + m)`, `Phi <= tolerance` after at most
///   `2 Phi(0) / (dt m) + ln(Phi(0) / tolerance) / ln(1 / r)` steps, rounded up one by one.
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
/// So every computed rollout ends on the goal after enough steps. [`StableStep::limit`] states which case applied.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash)]
pub struct StableEuler;

/// The limit of the length of a [`StableEuler`] step.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum StepLimit {
    /// The time step: a plain Euler step.
    TimeStep,
    /// The point of the line of motion closest to the goal, possibly the goal itself.
    ClosestApproach,
    /// The spacing of floating-point numbers: the smallest move that changes the distance.
    Resolution,
    /// The pedestrian was at the goal and did not move.
    AtGoal,
}

/// A [`StableEuler`] step: its end, and its limit.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct StableStep<T, const D: usize> {
    /// The next position (metres).
    pub position: SVector<T, D>,
    /// The limit of the length of the step.
    pub limit: StepLimit,
}

impl StableEuler {
    /// One step from `position` (metres) with `velocity` (m/s) for at most `dt` (seconds).
    ///
    /// # Errors
    /// [`DynamicsError::NotPositive`] for the time step; [`DynamicsError::NonFinite`] for the position or the velocity;
    /// [`DynamicsError::DistanceTooLarge`] if the distance to the goal overflows.
    pub fn advance<T: Real, const D: usize>(
        attractor: &Attractor<T, D>,
        position: &SVector<T, D>,
        velocity: &SVector<T, D>,
        dt: T,
    ) -> Result<StableStep<T, D>, DynamicsError> {
        descend(attractor, position, velocity, dt, |next| *next)
    }
}

/// [`StableEuler::advance`], but `settled` is applied to a position before its distance is measured. It transforms the
/// position to another space and back, so that the decrease holds for the rounded values.
#[inline]
fn descend<T: Real, const D: usize>(
    attractor: &Attractor<T, D>,
    position: &SVector<T, D>,
    velocity: &SVector<T, D>,
    dt: T,
    settled: impl Fn(&SVector<T, D>) -> SVector<T, D>,
) -> Result<StableStep<T, D>, DynamicsError> {
    ensure_time_step(dt)?;
    ensure_finite("position", position)?;
    ensure_finite("velocity", velocity)?;
    let (distance, away) = attractor.distance_and_direction(position);
    if !distance.is_finite() {
        return Err(DynamicsError::DistanceTooLarge);
    }
    let ended = |position, limit| Ok(StableStep { position, limit });
    if distance.is_zero() {
        return ended(*position, StepLimit::AtGoal);
    }
    // Spacing of floating-point numbers at the coarser of the two points; never 0, so that doubling works.
    let resolution = (T::EPSILON * position.amax().max(attractor.goal().amax())).max(T::MIN_POSITIVE);

    let (speed, heading) = polar(velocity);
    let cosine = -away.dot(&heading);
    if cosine > T::zero() {
        let reach = distance * cosine;
        let (next, limit) = if dt * speed <= reach {
            (position + velocity * dt, StepLimit::TimeStep)
        } else {
            (position + heading * reach, StepLimit::ClosestApproach)
        };
        let left = attractor.distance(&settled(&next));
        if limit == StepLimit::ClosestApproach && left <= T::rounded(ARRIVAL) * resolution {
            return ended(*attractor.goal(), limit);
        }
        if left < distance {
            return ended(next, limit);
        }
    }
    // The shortest of the moves `resolution * 2^k` straight to the goal that lowers the computed distance, or the goal.
    // There are few doublings, because the distance is at most `2 sqrt(D) resolution / epsilon`.
    let mut length = resolution;
    loop {
        if length >= distance {
            return ended(*attractor.goal(), StepLimit::Resolution);
        }
        let next = position - away * length;
        if attractor.distance(&settled(&next)) < distance {
            return ended(next, StepLimit::Resolution);
        }
        length += length;
    }
}

impl<T: Real, const D: usize> Integrator<T, D> for StableEuler {
    /// For a flow with a [`chart`](Flow::chart) the step is taken in the coordinates of the chart.
    fn step<F: Flow<T, D> + ?Sized>(
        &self,
        flow: &F,
        state: &State<'_, T, D>,
        dt: T,
    ) -> Result<SVector<T, D>, DynamicsError> {
        let Some(psi) = flow.chart() else {
            let velocity = flow.velocity(state)?;
            let dt = flow
                .longest_step(state, &velocity)
                .map_or(dt, |longest| longest.min(dt));
            return Self::advance(flow.attractor(), &state.position, &velocity, dt).map(|step| step.position);
        };
        // In the coordinates of the chart the flow is a natural gradient: take the step there and transform back.
        let image = psi.apply(&state.position);
        let velocity = -flow.metric(state)?.apply(&flow.attractor().gradient(&image));
        let attractor = flow.attractor();
        let step = descend(attractor, &image, &velocity, dt, |next| psi.apply(&psi.inverse(next)))?;
        match step.limit {
            StepLimit::AtGoal => Ok(state.position),
            _ if step.position == *attractor.goal() => Ok(*flow.goal()),
            _ => {
                let next = psi.inverse(&step.position);
                ensure_finite("next position", &next).copied()
            }
        }
    }
}
