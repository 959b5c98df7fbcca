//! A flow that avoids obstacles and other pedestrians and still reaches the goal.

use nalgebra::SVector;

use super::{Flow, NaturalGradientFlow};
use crate::{
    attractor::Attractor,
    error::{DynamicsError, ensure_positive},
    metric::CholeskyMetric,
    metric_source::MetricSource,
    obstacle::ObstacleSource,
    real::Real,
    state::State,
};

/// A [`NaturalGradientFlow`] that slows its approach to obstacles and slides along them.
///
/// Let `gap` be the distance from the surface of a ball, and `n` the unit vector away from it. A pedestrian that
/// approaches the ball keeps the share `gap / margin` of its speed along `n`:
///
/// ```text
/// P' = P - (1 - share) q q^T / (n^T q)     q = P n     share = min(1, gap / margin)    n^T v' = share n^T v
/// ```
///
/// ([`damped_along`](CholeskyMetric::damped_along)), for one ball after the other. A pedestrian that moves away from a
/// ball is not slowed by it. With one ball near, the velocity is continuous.
///
/// # What is guaranteed
/// For balls that do not move (Lemma 5 and Theorem 6 of `PROOFS.md`):
/// - *The distance to the goal still falls* everywhere outside the balls: `P' >= share P` is positive definite.
/// - *No ball is entered*: the pedestrian moves away from each ball or is slowed, `|n^T v'| <= sqrt(2 share)
///   lambda_max`.
/// - *The goal is the only attractor*, if it is outside all balls, the balls do not touch, and the eigenvalues of `P`
///   stay within `[m, M]`, `m > 0`. Each ball has one more equilibrium, a saddle straight behind it. Balls that touch
///   or overlap can form a dead end.
///
/// In steps of finite length with [`StableEuler`](crate::StableEuler) the same holds, because
/// [`longest_step`](Flow::longest_step) ends a step where half of the gap along `n` is used up.
///
/// # Numerics
/// The decrease has priority. A pedestrian at a saddle still makes the smallest move to the goal that changes the
/// computed distance, and so it enters the ball by a few rounding errors. On a surface, an approach speed of
/// `epsilon lambda_max` remains; between several balls, up to `sqrt(2 epsilon) lambda_max`. In `f64` both are
/// negligible; in `f32` allow some millimetres.
///
/// # Obstacles that move
/// The decrease of the distance does not depend on the obstacles. To avoid moving obstacles, give each step the
/// obstacles as they will be at its end ([`ObstacleSchedule`](crate::ObstacleSchedule)). A pedestrian outside these at
/// the start of a step is outside them at its end. A pedestrian in the way of an obstacle does not step aside.
///
/// # References
/// Similar to Khansari-Zadeh and Billard, "A dynamical system approach to realtime obstacle avoidance" (Autonomous
/// Robots 2012), which modulates the velocity by a matrix that is not symmetric.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AvoidingFlow<T, const D: usize, M, O> {
    flow: NaturalGradientFlow<T, D, M>,
    obstacles: O,
    margin: T,
}

impl<T, const D: usize, M, O> AvoidingFlow<T, D, M, O>
where
    T: Real,
    M: MetricSource<T, D>,
    O: ObstacleSource<T, D>,
{
    /// `flow`, slowed within `margin` (metres) of the surfaces of `obstacles`.
    ///
    /// With a margin of twice the speed times the time step, no step is shortened if only one obstacle is near.
    ///
    /// # Errors
    /// [`DynamicsError::NotPositive`] unless the margin is positive and finite.
    pub fn new(flow: NaturalGradientFlow<T, D, M>, obstacles: O, margin: T) -> Result<Self, DynamicsError> {
        Ok(Self {
            flow,
            obstacles,
            margin: ensure_positive("the margin around obstacles", " m", margin)?,
        })
    }

    fn surfaces<'a>(&'a self, state: &'a State<T, D>) -> impl Iterator<Item = (T, SVector<T, D>)> + 'a {
        let balls = self.obstacles.obstacles(state).iter();
        balls.map(|ball| ball.gap_and_normal(&state.position))
    }
}

impl<T, const D: usize, M, O> Flow<T, D> for AvoidingFlow<T, D, M, O>
where
    T: Real,
    M: MetricSource<T, D>,
    O: ObstacleSource<T, D>,
{
    fn attractor(&self) -> &Attractor<T, D> {
        self.flow.attractor()
    }

    fn metric(&self, state: &State<T, D>) -> Result<CholeskyMetric<T, D>, DynamicsError> {
        let free = self.flow.metric(state)?;
        let gradient = self.attractor().gradient(&state.position);
        let mut metric = free;
        let near = || {
            self.surfaces(state)
                .filter(|(gap, _)| *gap < self.margin)
                // On the surface and inside, the smallest share that keeps P positive definite.
                .map(|(gap, normal)| ((gap / self.margin).max(T::EPSILON), normal))
        };
        // Sliding along one ball may turn the pedestrian towards another one. Each round slows the approach to one more
        // ball; otherwise the loop ends.
        for round in 0..near().count() {
            let mut slowed = false;
            for (share, normal) in near() {
                let remaining = metric.quadratic_form(&normal);
                let slow = round > 0 && remaining <= free.quadratic_form(&normal) * (share + share);
                if !slow && normal.dot(&metric.apply(&gradient)) > T::zero() {
                    metric = metric.damped_along(&normal, share)?;
                    slowed = true;
                }
            }
            if !slowed {
                break;
            }
        }
        Ok(metric)
    }

    fn longest_step(&self, state: &State<T, D>, velocity: &SVector<T, D>) -> Option<T> {
        self.surfaces(state)
            .filter_map(|(gap, normal)| {
                let approach = -normal.dot(velocity);
                let limits = gap > T::zero() && approach > T::zero();
                // A limit too small for `T` must still be positive.
                limits.then(|| (gap / approach * T::rounded(0.5)).max(T::MIN_POSITIVE))
            })
            .reduce(T::min)
    }
}
