//! Random scenes, drawn as `f64` in three dimensions and reduced to the space under test.

use ddl_dynamics::{
    Attractor, CholeskyMetric, EigenvalueRange, MetricSchedule, NaturalGradientFlow, PUBLISHED_SIGMA, Real, State,
};
use nalgebra::{SMatrix, SVector};
use proptest::{array::uniform3, collection::vec, prelude::*};

pub(crate) const METRICS: usize = 12;

/// Entries of a factor, row by row (the upper triangle is not used), and sigma.
pub(crate) type MetricDraw = ([[f64; 3]; 3], f64);

#[derive(Debug, Clone)]
pub(crate) struct SceneDraw {
    start: [f64; 3],
    goal: [f64; 3],
    metrics: Vec<MetricDraw>,
    dt: f64,
    direction: [f64; 3],
}

/// A number of either sign: any up to `largest`, zero, or of any magnitude down to 1e-12.
fn signed(largest: f64) -> impl Strategy<Value = f64> {
    prop_oneof![
        4 => -largest..=largest,
        1 => Just(0.0),
        3 => (-12.0..=largest.log10(), any::<bool>())
            .prop_map(|(exponent, negative)| 10_f64.powf(exponent) * if negative { -1.0 } else { 1.0 }),
    ]
}

fn metric_draw(largest: f64) -> impl Strategy<Value = MetricDraw> {
    let sigma = prop_oneof![Just(PUBLISHED_SIGMA), (-8.0..=0.0).prop_map(|x| 10_f64.powf(x))];
    (uniform3(uniform3(signed(largest))), sigma)
}

fn scene_with(metric: impl Strategy<Value = MetricDraw>) -> impl Strategy<Value = SceneDraw> {
    let dt = (-3.0..=2.0).prop_map(|exponent| 10_f64.powf(exponent));
    (uniform3(signed(1e3)), uniform3(signed(1e3)), vec(metric, METRICS), dt, uniform3(signed(1.0)))
        .prop_map(|(start, goal, metrics, dt, direction)| SceneDraw { start, goal, metrics, dt, direction })
}

/// Factors up to 1e3, including singular and extremely ill-conditioned ones.
pub(crate) fn any_scene() -> impl Strategy<Value = SceneDraw> {
    scene_with(metric_draw(1e3))
}

pub(crate) fn well_conditioned_scene() -> impl Strategy<Value = SceneDraw> {
    let entry = || -0.5..=0.5;
    let diagonal = || prop_oneof![0.5..=2.0, -2.0..=-0.5];
    let factor = (uniform3(diagonal()), uniform3(entry()))
        .prop_map(|(d, low)| [[d[0], 0.0, 0.0], [low[0], d[1], 0.0], [low[1], low[2], d[2]]]);
    scene_with((factor, Just(PUBLISHED_SIGMA)))
}

pub(crate) fn wild_scene() -> impl Strategy<Value = SceneDraw> {
    use proptest::num::f64::{NORMAL, POSITIVE, SUBNORMAL};
    let places = [wild(), wild(), wild()].map(uniform3);
    let dt = POSITIVE | NORMAL | SUBNORMAL;
    (any_scene(), places, dt).prop_map(|(scene, [start, goal, direction], dt)| SceneDraw {
        start,
        goal,
        dt,
        direction,
        ..scene
    })
}

fn wild() -> impl Strategy<Value = f64> + Copy {
    use proptest::num::f64::{NEGATIVE, NORMAL, POSITIVE, SUBNORMAL, ZERO};
    POSITIVE | NEGATIVE | NORMAL | SUBNORMAL | ZERO
}

fn vector<T: Real, const D: usize>(draw: &[f64; 3]) -> SVector<T, D> {
    // A draw too large for f32 becomes its largest number and stays finite.
    SVector::from_fn(|i, _| {
        let largest = T::MAX.as_f64();
        T::rounded(draw[i].clamp(-largest, largest))
    })
}

impl SceneDraw {
    pub(crate) fn start<T: Real, const D: usize>(&self) -> SVector<T, D> {
        vector(&self.start)
    }

    pub(crate) fn attractor<T: Real, const D: usize>(&self) -> Attractor<T, D> {
        Attractor::new(vector(&self.goal)).unwrap()
    }

    pub(crate) fn metrics<T: Real, const D: usize>(&self) -> Vec<CholeskyMetric<T, D>> {
        self.metrics.iter().map(metric).collect()
    }

    pub(crate) fn flow<T: Real, const D: usize>(&self) -> NaturalGradientFlow<T, D, MetricSchedule<T, D>> {
        NaturalGradientFlow::new(self.attractor(), MetricSchedule::new(self.metrics()).unwrap())
    }

    /// The time step (seconds): positive and finite in `T`.
    pub(crate) fn dt<T: Real>(&self) -> T {
        T::rounded(self.dt.clamp(T::MIN_POSITIVE.as_f64(), T::MAX.as_f64()))
    }

    /// A random unit vector, or `None` when all its components were drawn as 0.
    pub(crate) fn unit<T: Real, const D: usize>(&self) -> Option<SVector<T, D>> {
        vector::<T, D>(&self.direction).try_normalize(T::rounded(1e-30))
    }

    pub(crate) fn direction<T: Real, const D: usize>(&self) -> SVector<T, D> {
        vector(&self.direction)
    }
}

fn metric<T: Real, const D: usize>((entries, sigma): &MetricDraw) -> CholeskyMetric<T, D> {
    let factor = SMatrix::from_fn(|row, column| T::rounded(if column > row { 0.0 } else { entries[row][column] }));
    CholeskyMetric::new(factor, T::rounded(*sigma)).unwrap()
}

/// The state at the start of a rollout.
pub(crate) fn at<T: Real, const D: usize>(position: SVector<T, D>) -> State<T, D> {
    State::new(position, 0, T::zero())
}

/// Sine of the largest angle between a flow and the direction to its goal (Wielandt's form of the Kantorovich
/// inequality). A step to the closest point of the line of motion multiplies the distance by at most this number.
pub(crate) fn deviation_sine<T: Real>(range: EigenvalueRange<T>) -> T {
    (range.largest - range.smallest) / (range.largest + range.smallest)
}

/// `P = L L^T + sigma I` in `f64` by nalgebra's matrix product, independent of the implementation.
pub(crate) fn formed<T: Real, const D: usize>(metric: &CholeskyMetric<T, D>) -> SMatrix<f64, D, D> {
    let factor = metric.factor().map(Real::as_f64);
    factor * factor.transpose() + SMatrix::identity() * metric.sigma().as_f64()
}
