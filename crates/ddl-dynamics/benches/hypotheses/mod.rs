//! Synthetic hypotheses: a pedestrian, a goal, and a metric for each of 12 steps, as from a network.

use ddl_dynamics::{Attractor, CholeskyMetric, MetricSchedule, NaturalGradientFlow, PUBLISHED_SIGMA, Real};
use nalgebra::{SMatrix, SVector};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

pub(crate) const STEPS: usize = 12;
/// Seconds of a step.
pub(crate) const TIME_STEP: f64 = 0.4;

pub(crate) struct MadeUpWalk<T, const D: usize> {
    pub(crate) start: SVector<T, D>,
    pub(crate) flow: NaturalGradientFlow<T, D, MetricSchedule<T, D>>,
    /// One for each step.
    #[allow(dead_code, reason = "for the certificates of the benchmark")]
    pub(crate) metrics: Vec<CholeskyMetric<T, D>>,
}

/// Pedestrians at about 1 m/s, 2 to 6 m from their goals in any direction, with deviations to either side. About half
/// of them arrive within the 4.8 s. The draws are the same in every precision.
pub(crate) fn drawn<T: Real, const D: usize>(count: usize, seed: u64) -> Vec<MadeUpWalk<T, D>> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut between = |low: f64, high: f64| rng.random_range(low..high);
    (0..count)
        .map(|_| {
            let start: SVector<f64, D> = SVector::from_fn(|_, _| between(-10.0, 10.0));
            let heading = SVector::<f64, D>::from_fn(|_, _| between(-1.0, 1.0));
            let goal = start + heading.normalize() * between(2.0, 6.0);
            let factor = SMatrix::<f64, D, D>::from_fn(|row, column| match row.cmp(&column) {
                std::cmp::Ordering::Less => 0.0,
                std::cmp::Ordering::Equal => between(0.8, 1.1),
                std::cmp::Ordering::Greater => between(-0.4, 0.4),
            });
            let mut metric = || {
                let sway = 1.0 + between(-0.1, 0.1);
                let factor = factor.map(|entry| T::rounded(entry * sway));
                CholeskyMetric::new(factor, T::rounded(PUBLISHED_SIGMA)).expect("finite")
            };
            let metrics: Vec<_> = (0..STEPS).map(|_| metric()).collect();
            let schedule = MetricSchedule::new(metrics.clone()).expect("12 metrics");
            let attractor = Attractor::new(goal.map(T::rounded)).expect("finite");
            MadeUpWalk {
                start: start.map(T::rounded),
                flow: NaturalGradientFlow::new(attractor, schedule),
                metrics,
            }
        })
        .collect()
}
