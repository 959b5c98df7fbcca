//! `StableEuler` lowers the distance to the goal at every step, for every input.

use crate::{
    draw::{METRICS, SceneDraw, at},
    for_every_space,
};
use ddl_dynamics::{
    Attractor, CholeskyMetric, Euler, Integrator, LyapunovCertificate, NaturalGradientFlow, Real, StableEuler, State,
    rollout,
};
use nalgebra::{SVector, Vector2};
use proptest::{prelude::*, test_runner::TestCaseResult};

fn at_the_goal_nothing_moves<T: Real, const D: usize>(scene: &SceneDraw) -> TestCaseResult {
    let attractor = scene.attractor::<T, D>();
    let goal = *attractor.goal();
    let flow = scene.flow();
    let here = at(goal);
    prop_assert_eq!(flow.velocity(&here).unwrap(), SVector::<T, D>::zeros());
    prop_assert_eq!(Euler.step(&flow, &here, scene.dt()).unwrap(), goal);
    let path = rollout(&flow, &StableEuler, goal, scene.dt(), METRICS).unwrap();
    prop_assert!(path.iter().all(|position| *position == goal));
    let certificate = LyapunovCertificate::of_rollout(&flow, &path, scene.dt()).unwrap();
    prop_assert_eq!(certificate.verify(), Ok(()));
    for step in certificate.steps() {
        prop_assert!(step.rate.is_zero() && step.angle.is_zero() && step.step_margin.is_none());
    }
    Ok(())
}
for_every_space!(at_the_goal_nothing_moves, any_scene);

fn no_finite_input_breaks_it<T: Real, const D: usize>(scene: &SceneDraw) -> TestCaseResult {
    let attractor = scene.attractor::<T, D>();
    let start = scene.start::<T, D>();
    let before = attractor.distance(&start);
    match StableEuler::advance(&attractor, &start, &scene.direction(), scene.dt()) {
        Ok(next) => {
            prop_assert!(next.iter().all(nalgebra::ComplexField::is_finite));
            prop_assert!(attractor.distance(&next) < before || before.is_zero());
        }
        Err(_) => prop_assert!(!before.is_finite()),
    }
    Ok(())
}
for_every_space!(no_finite_input_breaks_it, wild_scene);

/// A step that ends before the closest point of its line is exactly the Euler step, a longer one ends at that point.
/// Neither is longer than the Euler step, and `Phi' <= Phi - h u^T P u / 2`. Rounding may replace both by the smallest
/// move to the goal.
fn step_is_as_long_as_proved<T: Real, const D: usize>(scene: &SceneDraw) -> TestCaseResult {
    let attractor = scene.attractor::<T, D>();
    let (start, dt) = (scene.start::<T, D>(), scene.dt::<T>());
    let (before, away) = (attractor.distance(&start), attractor.gradient(&start));
    let noise = T::rounded(32.0) * T::EPSILON * start.amax().max(attractor.goal().amax());
    for metric in scene.metrics::<T, D>() {
        let flow = NaturalGradientFlow::new(attractor, metric);
        let velocity = flow.velocity(&at(start)).unwrap();
        let next = StableEuler::advance(&attractor, &start, &velocity, dt).unwrap();
        let (length, speed) = ((next - start).norm(), velocity.norm());
        prop_assert!(length <= dt * speed + noise);
        prop_assert!(length <= before + noise);
        if length <= noise {
            continue;
        }
        let rate = -away.dot(&velocity);
        // Where the line of motion is closest to the goal.
        let closest = before * rate / speed;
        if dt * speed < closest - noise {
            prop_assert_eq!(next, Euler.step(&flow, &at(start), dt).unwrap());
        } else if dt * speed > closest + noise {
            // The foot of the perpendicular: the remaining offset is at right angles to the velocity.
            let along = (next - attractor.goal()).dot(&velocity).abs();
            prop_assert!(along <= (noise + noise) * speed);
        }
        let half_descent = rate * length / speed / T::rounded(2.0);
        prop_assert!(attractor.distance(&next) <= before - half_descent + noise);
    }
    Ok(())
}
for_every_space!(step_is_as_long_as_proved, any_scene);

#[test]
fn a_step_below_the_spacing_of_f32_still_shows() {
    // 1e-8 m/s for 0.4 s at 1 m are 4e-9 m, too small to change 1.0_f32. Plain Euler does not move.
    let attractor = Attractor::new(Vector2::<f32>::zeros()).unwrap();
    let metric = CholeskyMetric::planar(0.0, 0.0, 0.0, 1e-8).unwrap();
    let flow = NaturalGradientFlow::new(attractor, metric);
    let start = Vector2::new(1.0, 0.0);
    assert_eq!(Euler.step(&flow, &at(start), 0.4).unwrap(), start);
    let velocity = flow.velocity(&at(start)).unwrap();
    let step = StableEuler::advance(&attractor, &start, &velocity, 0.4).unwrap();
    assert_eq!(step, Vector2::new(1.0 - f32::EPSILON, 0.0));
    // One spacing from the goal: the next number is the goal itself.
    let near = Attractor::new(Vector2::new(1.0_f32.next_down(), 0.0)).unwrap();
    assert_eq!(StableEuler::advance(&near, &start, &velocity, 0.4).unwrap(), *near.goal());
}

#[test]
fn values_that_are_not_finite_are_refused() {
    let attractor = Attractor::new(Vector2::new(0.0, 0.0)).unwrap();
    let one = Vector2::new(1.0, 0.0);
    let message = |position: Vector2<f64>, velocity: Vector2<f64>, dt| {
        StableEuler::advance(&attractor, &position, &velocity, dt).unwrap_err().to_string()
    };
    assert!(message(one, one, 0.0).contains("time step is 0 s"));
    assert!(message(one, one, f64::NAN).contains("time step is NaN s"));
    assert!(message(Vector2::new(0.0, f64::NAN), one, 1.0).contains("component 1 of the position"));
    assert!(message(one, Vector2::new(f64::INFINITY, 0.0), 1.0).contains("of the velocity is inf"));
    let far = Vector2::repeat(f64::MAX);
    assert!(message(far, one, 1.0).contains("distance from the position to the goal overflows"));
}

#[test]
fn the_failing_step_of_a_rollout_is_reported() {
    let attractor = Attractor::new(Vector2::new(0.0, 0.0)).unwrap();
    let source = |state: &State<f64, 2>| {
        let a = if state.step == 3 { f64::NAN } else { 1.0 };
        CholeskyMetric::planar(a, 0.0, 1.0, 1e-8)
    };
    let flow = NaturalGradientFlow::new(attractor, source);
    let error = rollout(&flow, &StableEuler, Vector2::new(9.0, 0.0), 0.4, 12).unwrap_err();
    assert_eq!(
        error.to_string(),
        "step 3 of the rollout failed: \
         entry (0, 0) of the Cholesky factor is NaN: it must be a finite number"
    );
}

#[test]
fn a_flow_receives_step_and_time() {
    let attractor = Attractor::new(SVector::<f64, 1>::new(0.0)).unwrap();
    let source = |state: &State<f64, 1>| {
        assert!((state.time - 0.5 * state.step as f64).abs() < 1e-15);
        CholeskyMetric::new([[1.0]].into(), 1e-8)
    };
    let flow = NaturalGradientFlow::new(attractor, source);
    let path = rollout(&flow, &StableEuler, SVector::<f64, 1>::new(9.0), 0.5, 5).unwrap();
    assert_eq!(path.len(), 6);
}
