//! Certificates hold for every stable rollout, and name the step that violates the guarantee.

use crate::{
    draw::{METRICS, SceneDraw},
    for_every_space,
};
use approx::assert_relative_eq;
use ddl_dynamics::{
    Attractor, CholeskyMetric, DynamicsError, Euler, LyapunovCertificate, NaturalGradientFlow, PUBLISHED_SIGMA, Real,
    StableEuler, Violation, rollout,
};
use nalgebra::{SVector, Vector2};
use proptest::{prelude::*, test_runner::TestCaseResult};

fn stable_path<T: Real, const D: usize>(
    scene: &SceneDraw,
) -> (Vec<SVector<T, D>>, Vec<CholeskyMetric<T, D>>, Attractor<T, D>) {
    let flow = scene.flow();
    let path = rollout(&flow, &StableEuler, scene.start(), scene.dt(), METRICS).unwrap();
    (path, scene.metrics(), scene.attractor())
}

/// The certificate of every `StableEuler` rollout holds, its quantities are within their bounds, and its rate agrees
/// with the formed matrix.
fn holds_for_every_stable_rollout<T: Real, const D: usize>(scene: &SceneDraw) -> TestCaseResult {
    let (path, metrics, attractor) = stable_path::<T, D>(scene);
    let certificate = LyapunovCertificate::new(&path, &metrics, &attractor, scene.dt()).unwrap();
    prop_assert_eq!(certificate.verify(), Ok(()));
    prop_assert!(certificate.potentials().eq(path.iter().map(|p| attractor.distance(p))));
    for ((step, metric), position) in certificate.steps().iter().zip(&metrics).zip(&path) {
        let u = attractor.gradient(position).map(Real::as_f64);
        let p = crate::draw::formed(metric);
        let tolerance = 32.0 * T::EPSILON.as_f64() * p.norm();
        prop_assert!((step.rate.as_f64() + u.dot(&(p * u))).abs() <= tolerance);
        prop_assert!(step.min_eigenvalue >= metric.sigma());
        prop_assert!(step.step_margin.is_none_or(|margin| margin <= T::one()));
    }
    Ok(())
}
for_every_space!(holds_for_every_stable_rollout, any_scene);

fn names_a_planted_violation<T: Real, const D: usize>(scene: &SceneDraw) -> TestCaseResult {
    let (mut path, metrics, attractor) = stable_path::<T, D>(scene);
    // The random time step selects the place.
    let planted = (scene.dt::<T>().as_f64() * 1e6) as usize % METRICS;
    let before = attractor.distance(&path[planted]);
    let mut away = attractor.gradient(&path[planted]);
    if before.is_zero() {
        away[0] = T::one();
    }
    path[planted + 1] = path[planted] + away * (T::one() + before * T::rounded(0.5));
    let certificate = LyapunovCertificate::new(&path, &metrics, &attractor, scene.dt()).unwrap();
    match certificate.verify() {
        Err(Violation::NotDecreasing { step, .. }) => prop_assert_eq!(step, planted),
        Err(Violation::LeftGoal { step, .. }) => {
            prop_assert_eq!(step, planted);
            prop_assert!(before.is_zero());
        }
        verdict => prop_assert!(false, "{verdict:?}"),
    }
    Ok(())
}
for_every_space!(names_a_planted_violation, any_scene);

/// P = [1 1; 1 2] and e = (0.3, -0.4): the quantities of a step, computed by hand.
fn by_hand() -> LyapunovCertificate<f64> {
    let attractor = Attractor::new(Vector2::new(10.0, 20.0)).unwrap();
    let metric = CholeskyMetric::planar(1.0, 1.0, 1.0, 1e-16).unwrap();
    let path = [Vector2::new(10.3, 19.6), Vector2::new(10.38, 20.0)];
    LyapunovCertificate::new(&path, &[metric], &attractor, 0.4).unwrap()
}

#[test]
fn figures_by_hand() {
    let certificate = by_hand();
    let step = certificate.steps()[0];
    assert_relative_eq!(step.potential, 0.5, epsilon = 1e-14);
    assert_relative_eq!(step.rate, -0.68, epsilon = 1e-14);
    // (3 - sqrt(5)) / 2
    assert_relative_eq!(step.min_eigenvalue, 0.381_966_011_250_105_1, epsilon = 1e-15);
    // dt_max = 2 * 0.5 * 0.68 / 1.04 = 17/26; 1 - 0.4 * 26/17 = 33/85
    assert_relative_eq!(step.step_margin.unwrap(), 33.0 / 85.0, epsilon = 1e-13);
    // The move (0.08, 0.4) against the direction (-0.6, 0.8): cos = 0.272 / 0.4079...
    let cosine = 0.272_f64 / (0.08_f64 * 0.08 + 0.16).sqrt();
    assert_relative_eq!(step.angle, cosine.acos(), epsilon = 1e-12);
    assert_relative_eq!(certificate.final_potential(), 0.38, epsilon = 1e-14);
    assert_relative_eq!(certificate.largest_angle(), step.angle);
    assert_eq!(certificate.min_eigenvalue(), Some(step.min_eigenvalue));
    assert_eq!(certificate.min_step_margin(), step.step_margin);
    assert_eq!(certificate.goal(), [10.0, 20.0]);
    assert_eq!(certificate.verify(), Ok(()));
}

#[test]
fn a_deserialised_certificate_is_checked() {
    let text = serde_json::to_string(&by_hand()).unwrap();
    let read = |text: &str| serde_json::from_str::<LyapunovCertificate<f64>>(text).unwrap();
    assert_eq!(read(&text), by_hand());
    let with = |field: &str, value: f64| {
        let mut forged = serde_json::to_value(by_hand()).unwrap();
        forged["steps"][0][field] = value.into();
        read(&forged.to_string()).verify().unwrap_err()
    };
    let min_eigenvalue = 0.0;
    let not_definite = Violation::NotPositiveDefinite { step: 0, min_eigenvalue };
    assert_eq!(with("min_eigenvalue", 0.0), not_definite);
    assert_eq!(with("rate", 0.0), Violation::NotDescending { step: 0, rate: 0.0 });
    let after = by_hand().final_potential();
    assert_eq!(with("potential", 0.0), Violation::LeftGoal { step: 0, after });
}

#[test]
fn positions_and_metrics_must_belong_together() {
    let attractor = Attractor::new(Vector2::new(0.0, 0.0)).unwrap();
    let metric = CholeskyMetric::planar(1.0, 0.0, 1.0, 1e-8).unwrap();
    let position = Vector2::new(1.0, 0.0);
    let certify = |path: &[Vector2<f64>], metrics: &[CholeskyMetric<f64, 2>]| {
        LyapunovCertificate::new(path, metrics, &attractor, 0.4).unwrap_err()
    };
    for (path, metrics) in [(&[position, position][..], &[metric; 2][..]), (&[], &[])] {
        let (positions, metrics_given) = (path.len(), metrics.len());
        let mismatch = DynamicsError::LengthMismatch { positions, metrics: metrics_given };
        assert_eq!(certify(path, metrics), mismatch);
    }
    let broken = certify(&[position, Vector2::new(f64::NAN, 0.0)], &[metric]).to_string();
    assert!(broken.starts_with("step 1 of the rollout failed"), "{broken}");
}

/// The picture of `docs/stability.md`: to a goal 4 m away, 24 steps of 0.4 s with either integrator.
#[test]
fn the_flow_of_the_picture_circles_its_goal_or_ends_on_it() {
    let attractor = Attractor::new(Vector2::new(4.0, 0.0)).unwrap();
    let metric = CholeskyMetric::planar(1.1, 0.4, 1.1, PUBLISHED_SIGMA).unwrap();
    let flow = NaturalGradientFlow::new(attractor, metric);
    let euler = rollout(&flow, &Euler, Vector2::zeros(), 0.4, 24).unwrap();
    let nearest = euler.iter().map(|p| attractor.distance(p)).fold(f64::MAX, f64::min);
    assert!((0.02..0.03).contains(&nearest), "{nearest}");
    let verdict = LyapunovCertificate::of_rollout(&flow, &euler, 0.4).unwrap().verify();
    assert!(matches!(verdict, Err(Violation::NotDecreasing { step: 10, .. })), "{verdict:?}");
    let stable = rollout(&flow, &StableEuler, Vector2::zeros(), 0.4, 24).unwrap();
    assert_eq!(stable.iter().position(|p| p == attractor.goal()), Some(19));
}
