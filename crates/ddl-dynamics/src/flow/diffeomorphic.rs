//! A flow whose attractor is transformed by a diffeomorphism, for example around corners.

use nalgebra::SVector;

use super::Flow;
use crate::{
    attractor::Attractor,
    diffeomorphism::Diffeomorphism,
    error::{DynamicsError, ensure_finite},
    metric::CholeskyMetric,
    metric_source::MetricSource,
    real::Real,
    state::State,
};

/// Natural gradient descent on a potential transformed by a diffeomorphism `psi`:
///
/// ```text
/// V(p) = Phi(psi(p)) = |psi(p) - psi(p*)|        v = -P grad V = -P J^T u
/// ```
///
/// with `J` the Jacobian of `psi` at `p` and `u` the unit vector from `psi(p*)` to `psi(p)`.
///
/// A positive-definite matrix alone never turns a pedestrian by more than 90 degrees from the straight line to its
/// goal. This flow can turn further, because `V` falls and not the distance.
///
/// The metric may be given in space ([`new`](Self::new)), or in the coordinates of the chart
/// ([`in_chart`](Self::in_chart)): `v = -J^-1 P u`. With the identity for `P`, the second follows the lines that `psi`
/// maps to straight lines. If `psi` is the [straightening](crate::Chain::straightening) of a demonstrated path, it
/// follows that path.
///
/// # What is guaranteed
/// `dV/dt <= -lambda_min(P) s_min(J)^2 < 0` away from the goal, which is the only minimum of `V`. So the flow converges
/// to the goal from everywhere (Theorem 5 of `PROOFS.md`). In the coordinates `y = psi(p)`, the [`chart`](Flow::chart),
/// the flow is a [`NaturalGradientFlow`](crate::NaturalGradientFlow) with the metric `J P J^T`.
/// [`StableEuler`](crate::StableEuler) takes its steps there: `V` falls in every step, for every `dt`.
///
/// # References
/// The paper names diffeomorphisms as future work (section V). Rana et al., "Euclideanizing flows" (L4DC 2020), learn
/// such maps from demonstrations.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DiffeomorphicFlow<T, const D: usize, Psi, M> {
    goal: SVector<T, D>,
    attractor: Attractor<T, D>,
    psi: Psi,
    source: M,
    given: Given,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Given {
    InSpace,
    InChart,
}

impl<T, const D: usize, Psi, M> DiffeomorphicFlow<T, D, Psi, M>
where
    T: Real,
    Psi: Diffeomorphism<T, D>,
    M: MetricSource<T, D>,
{
    /// The flow to `goal` (metres) through `psi`, shaped by the metrics of `source`: `v = -P J^T u`.
    ///
    /// # Errors
    /// [`DynamicsError::NonFinite`] if the goal or its image is not finite.
    pub fn new(goal: SVector<T, D>, psi: Psi, source: M) -> Result<Self, DynamicsError> {
        Self::with_metric(goal, psi, source, Given::InSpace)
    }

    /// The same flow with metrics in the coordinates of the chart: `v = -J^-1 P u`.
    ///
    /// # Errors
    /// [`DynamicsError::NonFinite`] if the goal or its image is not finite.
    pub fn in_chart(goal: SVector<T, D>, psi: Psi, source: M) -> Result<Self, DynamicsError> {
        Self::with_metric(goal, psi, source, Given::InChart)
    }

    fn with_metric(goal: SVector<T, D>, psi: Psi, source: M, given: Given) -> Result<Self, DynamicsError> {
        ensure_finite("goal", &goal)?;
        let image = psi.apply(&goal);
        let attractor = Attractor::new(*ensure_finite("image of the goal", &image)?)?;
        Ok(Self {
            goal,
            attractor,
            psi,
            source,
            given,
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
    fn attractor(&self) -> &Attractor<T, D> {
        &self.attractor
    }

    fn goal(&self) -> &SVector<T, D> {
        &self.goal
    }

    /// The metric in the coordinates of the chart; a metric `P` in space becomes `J P J^T`.
    fn metric(&self, state: &State<'_, T, D>) -> Result<CholeskyMetric<T, D>, DynamicsError> {
        let metric = self.source.metric(state)?;
        match self.given {
            Given::InSpace => metric.transformed_by(&self.psi.jacobian(&state.position)),
            Given::InChart => Ok(metric),
        }
    }

    /// The velocity in space, `-P J^T u` or `-J^-1 P u`; also an error if the Jacobian has no inverse in `T`.
    fn velocity(&self, state: &State<'_, T, D>) -> Result<SVector<T, D>, DynamicsError> {
        let metric = self.source.metric(state)?;
        let (image, jacobian) = self.psi.apply_with_jacobian(&state.position);
        let away = self.attractor.gradient(&image);
        match self.given {
            Given::InSpace => Ok(-metric.apply(&jacobian.tr_mul(&away))),
            Given::InChart => {
                let back = jacobian.try_inverse().ok_or(DynamicsError::SingularMap)?;
                Ok(-(back * metric.apply(&away)))
            }
        }
    }

    fn chart(&self) -> Option<&dyn Diffeomorphism<T, D>> {
        Some(&self.psi)
    }
}
