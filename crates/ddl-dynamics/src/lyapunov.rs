//! Lyapunov certificates: evidence that a rollout kept the stability guarantee.

mod certified_step;
mod motion;
mod violation;

use crate::{
    attractor::Attractor,
    error::{DynamicsError, ensure_finite, ensure_time_step},
    flow::NaturalGradientFlow,
    metric::CholeskyMetric,
    metric_source::MetricSource,
    motion_bounds::MotionBounds,
    real::Real,
    state::State,
};
use nalgebra::SVector;
use serde::{Deserialize, Serialize};

pub use certified_step::CertifiedStep;
pub use motion::{Bounded, MotionEvidence};
pub use violation::Violation;

/// Evidence that a rollout approached its goal: the quantities of the stability proof for every step.
///
/// It is computed from the positions alone, for any integrator, so it can also check rollouts of other programs. It
/// does not check that the positions follow from the metrics, or that the pedestrian arrived
/// ([`final_potential`](Self::final_potential) is the remaining distance).
///
/// JSON keeps it exactly with the feature `float_roundtrip` of `serde_json`. Without the feature, rounding can change
/// the result of the strict check for a pedestrian that hardly moves.
///
/// # Examples
/// ```
/// use ddl_dynamics::{Attractor, CholeskyMetric, Euler, LyapunovCertificate, NaturalGradientFlow,
///     Violation, rollout};
/// use nalgebra::Vector2;
///
/// let attractor = Attractor::new(Vector2::new(1.0, 0.0))?;
/// let metric = CholeskyMetric::planar(1.0, 0.0, 1.0, 0.25)?;
/// let flow = NaturalGradientFlow::new(attractor, metric);
/// // 1.25 m/s: the second step, from 0.5 m before the goal to 0.75 m behind it, breaks the guarantee.
/// let path = rollout(&flow, &Euler, Vector2::new(-0.75, 0.0), 1.0, 2)?;
/// let certificate = LyapunovCertificate::of_rollout(&flow, &path, 1.0)?;
/// assert_eq!(
///     certificate.verify(),
///     Err(Violation::NotDecreasing { step: 1, before: 0.5, after: 0.75 }),
/// );
/// # Ok::<(), ddl_dynamics::DynamicsError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LyapunovCertificate<T> {
    goal: Vec<T>,
    time_step: T,
    steps: Vec<CertifiedStep<T>>,
    final_potential: T,
    #[serde(default = "Option::default", skip_serializing_if = "Option::is_none")]
    motion: Option<MotionEvidence<T>>,
}

impl<T: Real> LyapunovCertificate<T> {
    /// Adds the [motion](Self::motion) quantities and their bounds from [`MotionBounds`]. [`verify`](Self::verify) then
    /// checks these as well.
    ///
    /// # Shapes
    /// `path`: the positions of the certificate (metres), the start first.
    ///
    /// # Errors
    /// [`DynamicsError::LengthMismatch`], or [`DynamicsError::OtherPath`] if the distances from the goal differ from
    /// those of the certificate.
    pub fn within(
        self,
        path: &[SVector<T, 2>],
        attractor: &Attractor<T, 2>,
        bounds: &MotionBounds<T>,
    ) -> Result<Self, DynamicsError> {
        if path.len() != self.steps.len() + 1 {
            return Err(DynamicsError::LengthMismatch { positions: path.len(), metrics: self.steps.len() });
        }
        let distances = path.iter().map(|p| attractor.distance(p));
        // NaN differs from everything.
        if let Some(position) = distances.zip(self.potentials()).position(|(a, b)| a != b) {
            return Err(DynamicsError::OtherPath { position });
        }
        let motion = MotionEvidence::new(path, attractor, bounds, self.time_step);
        Ok(Self { motion: Some(motion), ..self })
    }

    /// Speed, change of speed, deviation from the straight line and final distance of the motion, with their bounds;
    /// `None` if no bounds were set.
    pub fn motion(&self) -> Option<&MotionEvidence<T>> {
        self.motion.as_ref()
    }

    /// The certificate of a rollout with steps of `dt` seconds.
    ///
    /// # Shapes
    /// `n + 1` positions (metres) and `n` metrics: `metrics[k]` is the metric at `positions[k]`.
    ///
    /// # Errors
    /// [`DynamicsError::LengthMismatch`], [`DynamicsError::NotPositive`], and, inside [`DynamicsError::Step`] with the
    /// index of the position, [`DynamicsError::NonFinite`] or [`DynamicsError::DistanceTooLarge`]. A rollout that
    /// violates the guarantee is not an error.
    pub fn new<const D: usize>(
        positions: &[SVector<T, D>],
        metrics: &[CholeskyMetric<T, D>],
        attractor: &Attractor<T, D>,
        dt: T,
    ) -> Result<Self, DynamicsError> {
        let mismatch = DynamicsError::LengthMismatch { positions: positions.len(), metrics: metrics.len() };
        let Some(last) = positions.last().filter(|_| positions.len() == metrics.len() + 1) else {
            return Err(mismatch);
        };
        ensure_time_step(dt)?;
        for (step, position) in positions.iter().enumerate() {
            let near = attractor.distance(position).is_finite();
            let measurable = near.then_some(()).ok_or(DynamicsError::DistanceTooLarge);
            let measurable = ensure_finite("position", position).and(measurable);
            measurable.map_err(|cause| DynamicsError::Step { step, cause: Box::new(cause) })?;
        }
        let steps = positions
            .windows(2)
            .zip(metrics)
            .map(|(pair, metric)| CertifiedStep::new(&pair[0], &pair[1], metric, attractor, dt))
            .collect();
        Ok(Self {
            goal: attractor.goal().iter().copied().collect(),
            time_step: dt,
            steps,
            final_potential: attractor.distance(last),
            motion: None,
        })
    }

    /// The certificate of a rollout of `flow` with steps of `dt` seconds.
    ///
    /// The flow is queried for its metric at each position.
    ///
    /// # Errors
    /// Those of [`new`](Self::new), and, inside [`DynamicsError::Step`], those of the flow's metric.
    pub fn of_rollout<const D: usize, M: MetricSource<T, D>>(
        flow: &NaturalGradientFlow<T, D, M>,
        path: &[SVector<T, D>],
        dt: T,
    ) -> Result<Self, DynamicsError> {
        let steps = path.len().saturating_sub(1);
        let mut metrics = Vec::with_capacity(steps);
        for (step, position) in path[..steps].iter().enumerate() {
            let state = State::new(*position, step, dt * T::rounded(step as f64));
            metrics.push(flow.metric(&state).map_err(|cause| DynamicsError::Step { step, cause: Box::new(cause) })?);
        }
        Self::new(path, &metrics, flow.attractor(), dt)
    }

    /// Checks the guarantee: `P` positive definite, `d Phi / dt < 0` and `Phi` strictly smaller after every step away
    /// from the goal, and no motion at the goal. If [bounds were set](Self::within), every [motion](Self::motion)
    /// quantity must be within its bound.
    ///
    /// # Errors
    /// The [`Violation`] of the first step that violates the guarantee.
    pub fn verify(&self) -> Result<(), Violation> {
        let after = self.potentials().skip(1);
        self.steps
            .iter()
            .zip(after)
            .enumerate()
            .try_for_each(|(step, (evidence, after))| evidence.check(step, after))?;
        self.motion.as_ref().map_or(Ok(()), MotionEvidence::check)
    }

    /// The goal (metres), `D` components.
    pub fn goal(&self) -> &[T] {
        &self.goal
    }

    /// The evidence of each step, in order.
    pub fn steps(&self) -> &[CertifiedStep<T>] {
        &self.steps
    }

    /// The distances to the goal at all positions, one more than steps (metres).
    pub fn potentials(&self) -> impl Iterator<Item = T> + '_ {
        self.steps.iter().map(|step| step.potential).chain([self.final_potential])
    }

    /// The distance to the goal after the last step (metres).
    pub fn final_potential(&self) -> T {
        self.final_potential
    }

    /// The smallest eigenvalue of all metrics (m/s); `None` if there are no steps.
    pub fn min_eigenvalue(&self) -> Option<T> {
        self.steps.iter().map(|step| step.min_eigenvalue).reduce(T::min)
    }

    /// The smallest of the step margins (no unit); `None` if no step has one.
    pub fn min_step_margin(&self) -> Option<T> {
        self.steps.iter().filter_map(|step| step.step_margin).reduce(T::min)
    }

    /// The largest angle between a move and the direction to the goal (radians); 0 if there are no steps.
    pub fn largest_angle(&self) -> T {
        self.steps.iter().map(|step| step.angle).fold(T::zero(), T::max)
    }
}
