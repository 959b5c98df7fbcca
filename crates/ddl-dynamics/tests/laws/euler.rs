//! The published scheme: what it does, and what it does not keep.

use ddl_dynamics::{
    Attractor, CholeskyMetric, Euler, Integrator, LyapunovCertificate, NaturalGradientFlow, Real,
    State, Violation, rollout,
};
use nalgebra::{Vector1, Vector2};
use proptest::{prelude::*, test_runner::TestCaseResult};

use crate::{draw::SceneDraw, for_every_space};

/// `|e'|^2 = |e|^2 - 2 dt |e| u^T P u + (dt |P u|)^2`. The middle term is not positive, so the others bound the overshoot.
fn the_step_is_the_law_of_cosines<T: Real, const D: usize>(scene: &SceneDraw) -> TestCaseResult {
    let attractor = scene.attractor::<T, D>();
    let (start, dt) = (scene.start::<T, D>(), scene.dt::<T>().as_f64());
    let (before, away) = attractor.potential_and_gradient(&start);
    let before = before.as_f64();
    for metric in scene.metrics::<T, D>() {
        let flow = NaturalGradientFlow::new(attractor, metric);
        let next = Euler.step(&flow, &State::at(start), scene.dt()).unwrap();
        let after = attractor.potential(&next).as_f64();
        let length = dt * metric.apply(&away).map(Real::as_f64).norm();
        let descent = 2.0 * dt * before * metric.quadratic_form(&away).as_f64();
        let expected = before * before - descent + length * length;
        let far = start.amax().max(attractor.goal().amax()).as_f64() + length;
        let noise = 64.0 * T::EPSILON.as_f64() * far * far;
        prop_assert!((after * after - expected).abs() <= noise);
    }
    Ok(())
}
for_every_space!(the_step_is_the_law_of_cosines, any_scene);

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    /// `|e'|^2 = |e|^2 + (dt |P u|)^2` to rounding where `P u` is at right angles to `u` to rounding: with
    /// `P = diag(a^2, 0)` but for sigma, and `u` off the second axis by a tiny angle.
    #[test]
    fn the_overshoot_bound_is_attained_up_to_rounding(
        a in 1.0..=1e3_f64,
        angle in -16.0..=-13.0_f64,
        distance in 1e-2..=1e2_f64,
        ratio in 0.1..=10.0_f64,
    ) {
        let angle = 10_f64.powf(angle);
        let attractor = Attractor::new(Vector2::zeros()).unwrap();
        let metric = CholeskyMetric::planar(a, 0.0, 0.0, 1e-30).unwrap();
        let flow = NaturalGradientFlow::new(attractor, metric);
        // dt |P u| = ratio |e|
        let dt = ratio * distance / (a * a * angle);
        let start = Vector2::new(angle, 1.0) * distance;
        let next = Euler.step(&flow, &State::at(start), dt).unwrap();
        let bound = distance * distance * (1.0 + ratio * ratio);
        prop_assert!((next.norm_squared() / bound - 1.0).abs() < 1e-12);
    }
}

#[test]
fn plain_euler_circles_the_goal_and_the_certificate_names_the_step() {
    // At 1 m/s in steps of 0.5 s from 1.25 m: 0.75, 0.25, then to and fro over the goal for ever.
    let attractor = Attractor::new(Vector1::new(0.0)).unwrap();
    let path = rollout(
        &NaturalGradientFlow::straight(attractor),
        &Euler,
        Vector1::new(1.25),
        0.5,
        6,
    )
    .unwrap();
    assert_eq!(
        path,
        [1.25, 0.75, 0.25, -0.25, 0.25, -0.25, 0.25].map(Vector1::new)
    );
    let metric = CholeskyMetric::new([[1.0]].into(), 1e-8).unwrap();
    let certificate = LyapunovCertificate::new(&path, &[metric; 6], &attractor, 0.5).unwrap();
    let violation = Violation::NotDecreasing {
        step: 2,
        before: 0.25,
        after: 0.25,
    };
    assert_eq!(certificate.holds(), Err(violation.clone()));
    assert_eq!(
        violation.to_string(),
        "step 2 does not approach the goal: 0.25 m away before it, 0.25 m after it"
    );
}

#[test]
fn the_published_step_of_four_tenths_circles_in_the_plane() {
    // A walker at 1.4 m/s with a bent path: the distance settles around dt times the speed, not at 0.
    let attractor = Attractor::new(Vector2::new(2.0, 1.0)).unwrap();
    let metric = CholeskyMetric::planar(1.1, 0.4, 1.2, 1e-8).unwrap();
    let flow = NaturalGradientFlow::new(attractor, metric);
    let path = rollout(&flow, &Euler, Vector2::zeros(), 0.4, 2000).unwrap();
    let nearest = path[1000..]
        .iter()
        .map(|p| attractor.potential(p))
        .fold(f64::MAX, f64::min);
    assert!(nearest > 0.05, "{nearest}");
    let certificate =
        LyapunovCertificate::new(&path, &vec![metric; 2000], &attractor, 0.4).unwrap();
    // The certificate's own bound tells the same: the first negative margin is the first violation.
    let negative = certificate
        .steps()
        .iter()
        .position(|step| step.step_margin < Some(0.0));
    let Err(Violation::NotDecreasing { step, .. }) = certificate.holds() else {
        panic!("plain Euler cannot hold: {:?}", certificate.holds())
    };
    assert_eq!(Some(step), negative);
}
