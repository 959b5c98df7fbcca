//! The goal is reached within a proved number of steps.

use crate::{
    draw::{SceneDraw, deviation_sine},
    for_every_space,
};
use ddl_dynamics::{Attractor, CholeskyMetric, NaturalGradientFlow, Real, StableEuler, State, rollout};
use nalgebra::{SVector, Vector2};
use proptest::{prelude::*, test_runner::TestCaseResult};

/// `Phi <= tolerance` after `2 Phi(0) / (dt m) + ln(Phi(0) / tolerance) / ln(1 / r)` steps.
fn arrives_within_the_proved_number_of_steps<T: Real, const D: usize>(scene: &SceneDraw) -> TestCaseResult {
    let attractor = scene.attractor::<T, D>();
    let (start, metric) = (scene.start::<T, D>(), scene.metrics::<T, D>()[0]);
    // A time step of at least a few seconds, so that a kilometre is not a million steps.
    let dt = scene.dt::<T>().max(T::rounded(2.0));
    let distance = attractor.distance(&start).as_f64();
    let tolerance = 256.0 * T::EPSILON.as_f64() * start.amax().max(attractor.goal().amax()).as_f64();
    if distance <= tolerance {
        return Ok(());
    }
    let range = metric.eigenvalue_range();
    let full = 2.0 * distance / (dt.as_f64() * range.smallest.as_f64());
    let limited = (distance / tolerance).ln() / -deviation_sine(range).as_f64().max(1e-9).ln();
    let steps = full.ceil() as usize + limited.ceil() as usize;
    let flow = NaturalGradientFlow::new(attractor, metric);
    let path = rollout(&flow, &StableEuler, start, dt, steps).unwrap();
    let left = attractor.distance(&path[steps]).as_f64();
    prop_assert!(left <= tolerance, "{left} m left of {distance} m after {steps} steps");
    Ok(())
}
for_every_space!(arrives_within_the_proved_number_of_steps, well_conditioned_scene);

/// Straight to the goal at 1 m/s: exactly on the goal after `Phi(0) / dt` steps, rounded up, plus one.
fn the_gradient_flow_arrives_exactly<T: Real, const D: usize>(scene: &SceneDraw) -> TestCaseResult {
    let attractor = scene.attractor::<T, D>();
    let start = scene.start::<T, D>();
    let dt = scene.dt::<T>().max(T::one());
    let steps = (attractor.distance(&start) / dt).as_f64().ceil() as usize + 1;
    let flow = NaturalGradientFlow::new(attractor, CholeskyMetric::identity());
    let path = rollout(&flow, &StableEuler, start, dt, steps).unwrap();
    prop_assert_eq!(path[steps], *attractor.goal());
    Ok(())
}
for_every_space!(the_gradient_flow_arrives_exactly, any_scene);

#[test]
fn every_rollout_ends_on_the_goal_even_when_nearly_singular() {
    // Eigenvalues 1e-8 and about 1: the continuous flow would need years. Rounding dominates, and the strict decrease
    // still brings the pedestrian to the goal.
    let attractor = Attractor::new(SVector::<f32, 2>::new(0.25, -0.5)).unwrap();
    let metric = CholeskyMetric::planar(1.0, 0.0, 0.0, 1e-8).unwrap();
    let flow = NaturalGradientFlow::new(attractor, metric);
    let start = attractor.goal() + SVector::<f32, 2>::new(1e-4, 1e-4);
    let path = rollout(&flow, &StableEuler, start, 0.4, 20_000).unwrap();
    assert_eq!(path[20_000], *attractor.goal());
}

/// In short steps, which follow the continuous flow, the goal is reached within `Phi(0) / lambda_min`, for metrics that
/// turn the motion to either side and change with time and place.
#[test]
fn the_continuous_flow_arrives_in_time() {
    let start = Vector2::new(-2.0, 1.0);
    let attractor = Attractor::new(Vector2::new(3.0, -1.0)).unwrap();
    let steps = 20_000;
    for lateral in [-1.5, -0.4, 0.0, 0.7, 2.0] {
        let metric = |state: &State<f64, 2>| {
            let lateral = lateral * (state.time + state.position.x).cos();
            CholeskyMetric::planar(1.1, lateral, 0.8, 1e-8)
        };
        // The product of the eigenvalues of L L^T is (1.1 x 0.8)^2, their sum at most 1.1^2 + 0.8^2 + lateral^2.
        let (product, sum) = (0.88_f64.powi(2), 1.85 + lateral * lateral);
        let smallest = sum / 2.0 - (sum * sum / 4.0 - product).sqrt();
        let dt = attractor.distance(&start) / smallest / f64::from(steps);
        let flow = NaturalGradientFlow::new(attractor, metric);
        let path = rollout(&flow, &StableEuler, start, dt, steps as usize).unwrap();
        assert_eq!(path[steps as usize], *attractor.goal(), "{lateral}");
        // Every step lowers the distance at the proved rate, up to the second order of its length.
        let speed = sum * dt;
        for pair in path.windows(2) {
            let [before, after] = [0, 1].map(|k| attractor.distance(&pair[k]));
            let fallen = before - after;
            assert!(fallen >= smallest * dt - speed * speed / before.max(speed) || after < speed, "{lateral}");
        }
    }
}
