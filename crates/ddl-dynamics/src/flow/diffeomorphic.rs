//! Around corners: the attractor seen through a diffeomorphism.

use nalgebra::SVector;

use super::Flow;
use crate::{
    attractor::Attractor, diffeomorphism::Diffeomorphism, error::DynamicsError,
    metric::CholeskyMetric, metric_source::MetricSource, real::Real, state::State,
};

/// Natural gradient descent on a potential bent by a diffeomorphism `psi`:
///
/// ```text
/// V(p) = Phi(psi(p)) = |psi(p) - psi(p*)|        v = -P grad V = -P J^T u
/// ```
///
/// with `J` the Jacobian of `psi` at `p` and `u` the unit vector from `psi(p*)` to `psi(p)`.
///
/// With a positive-definite matrix alone a walker never moves more than 90 degrees away from the
/// straight line to its goal: `-e^T v = e^T P u > 0`. Here it may, because it is `V` that falls and not
/// the distance: `psi` unbends space so that the way around the corner becomes a straight one.
///
/// # What is guaranteed
/// `dV/dt = -(J^T u)^T P (J^T u) <= -lambda_min(P) s_min(J)^2 < 0` away from the goal, as `J` is
/// invertible. `V` has no other minimum and no saddle, and grows without bound since `psi` is onto; so
/// the flow converges to `p*` from everywhere, after at most `V(p(0)) / (lambda_min(P) s_min(J)^2)`
/// seconds, both taken at their least along the path.
///
/// In the coordinates `y = psi(p)`, the [`chart`](Flow::chart), the flow is a
/// [`NaturalGradientFlow`](crate::NaturalGradientFlow) with the metric `J P J^T`:
/// `dy/dt = J v = -(J P J^T) u`. [`StableEuler`](crate::StableEuler) takes its steps there, and so keeps
/// its guarantee word for word: `V` falls in every step, for every `dt`.
///
/// # References
/// The paper names diffeomorphisms as future work (section V). Rana et al., "Euclideanizing flows"
/// (L4DC 2020), learn such maps from demonstrations; Perrin and Schlehuber-Caissier (2016) fit them in
/// closed form, see [`Chain::straightening`](crate::Chain::straightening).
///
/// # Examples
/// ```
/// use ddl_dynamics::{CholeskyMetric, DiffeomorphicFlow, LocalTranslation, StableEuler, rollout};
/// use nalgebra::Vector2;
///
/// // Space is pushed up around (1, 0): the way from (2, 0) to the origin bends downwards there.
/// let push = LocalTranslation::new(Vector2::new(1.0, 0.0), Vector2::new(0.0, 0.8), 1.0)?;
/// let metric = CholeskyMetric::planar(1.0, 0.0, 1.0, 1e-8)?;
/// let flow = DiffeomorphicFlow::new(Vector2::zeros(), push, metric)?;
/// let path = rollout(&flow, &StableEuler, Vector2::new(2.0, 0.0), 0.1, 40)?;
/// assert!(path.iter().any(|p| p.y < -0.2));
/// assert!(path[40].norm() < 1e-9);
/// # Ok::<(), ddl_dynamics::DynamicsError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DiffeomorphicFlow<T, const D: usize, Psi, M> {
    goal: SVector<T, D>,
    attractor: Attractor<T, D>,
    psi: Psi,
    source: M,
}

impl<T, const D: usize, Psi, M> DiffeomorphicFlow<T, D, Psi, M>
where
    T: Real,
    Psi: Diffeomorphism<T, D>,
    M: MetricSource<T, D>,
{
    /// The flow to `goal` (metres) through `psi`, shaped by the metrics of `source`.
    ///
    /// # Errors
    /// [`DynamicsError::NonFinite`] when the goal or its image is not finite.
    pub fn new(goal: SVector<T, D>, psi: Psi, source: M) -> Result<Self, DynamicsError> {
        crate::error::ensure_finite("goal", &goal)?;
        let attractor = Attractor::new(psi.apply(&goal))?;
        Ok(Self {
            goal,
            attractor,
            psi,
            source,
        })
    }

    /// The potential `V(p) = |psi(p) - psi(p*)|` (metres).
    pub fn potential(&self, position: &SVector<T, D>) -> T {
        self.attractor.potential(&self.psi.apply(position))
    }
}

impl<T, const D: usize, Psi, M> Flow<T, D> for DiffeomorphicFlow<T, D, Psi, M>
where
    T: Real,
    Psi: Diffeomorphism<T, D>,
    M: MetricSource<T, D>,
{
    /// The distance to `psi(p*)`, in the coordinates of the chart.
    fn attractor(&self) -> &Attractor<T, D> {
        &self.attractor
    }

    fn goal(&self) -> &SVector<T, D> {
        &self.goal
    }

    /// `J P J^T`, the metric in the coordinates of the chart.
    ///
    /// # Errors
    /// Those of the metric source and of [`CholeskyMetric::congruent`].
    fn metric(&self, state: &State<'_, T, D>) -> Result<CholeskyMetric<T, D>, DynamicsError> {
        let metric = self.source.metric(state)?;
        metric.congruent(&self.psi.jacobian(&state.position))
    }

    /// `-P J^T u`, in space.
    ///
    /// # Errors
    /// Those of the metric source.
    fn velocity(&self, state: &State<'_, T, D>) -> Result<SVector<T, D>, DynamicsError> {
        let metric = self.source.metric(state)?;
        let (image, jacobian) = self.psi.apply_with_jacobian(&state.position);
        Ok(-metric.apply(&jacobian.tr_mul(&self.attractor.gradient(&image))))
    }

    fn chart(&self) -> Option<&dyn Diffeomorphism<T, D>> {
        Some(&self.psi)
    }
}
