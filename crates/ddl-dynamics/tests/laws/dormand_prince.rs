//! The adaptive integrator follows the continuous flow and keeps the decrease.

use ddl_dynamics::{
    Attractor, CholeskyMetric, DormandPrince, DynamicsError, LyapunovCertificate, NaturalGradientFlow, Real,
    StableEuler, State, rollout,
};
use nalgebra::{DMatrix, SVector, SymmetricEigen, Vector2};
use proptest::{prelude::*, test_runner::TestCaseResult};

use crate::{
    draw::{SceneDraw, formed},
    for_every_space,
};

fn arrives_within_the_finite_time_bound<T: Real, const D: usize>(scene: &SceneDraw) -> TestCaseResult {
    let (attractor, start) = (scene.attractor::<T, D>(), scene.start::<T, D>());
    let metric = scene.metrics::<T, D>()[0];
    let distance = attractor.distance(&start);
    let size = start.amax().max(attractor.goal().amax());
    let precise = DormandPrince::new(T::rounded(64.0) * T::EPSILON * size.max(T::one())).unwrap();
    if distance <= precise.tolerance() {
        return Ok(());
    }
    let flow = NaturalGradientFlow::new(attractor, metric);
    let bound = distance / metric.eigenvalue_range().smallest;
    // One percent more, for the errors of the steps.
    let dt = bound * T::rounded(1.01) / T::rounded(8.0);
    let path = rollout(&flow, &precise, start, dt, 8).unwrap();
    let certificate = LyapunovCertificate::of_rollout(&flow, &path, dt).unwrap();
    prop_assert_eq!(certificate.verify(), Ok(()));
    prop_assert!(attractor.distance(&path[8]) <= precise.tolerance());
    Ok(())
}
for_every_space!(arrives_within_the_finite_time_bound, well_conditioned_scene);

/// On a quadratic attractor with a constant metric: `e(t) = exp(-P t) e(0)`, by eigenvectors.
fn follows_the_matrix_exponential<T: Real, const D: usize>(scene: &SceneDraw) -> TestCaseResult {
    let goal = *scene.attractor::<T, D>().goal();
    let attractor = Attractor::quadratic(goal).unwrap();
    let start = scene.start::<T, D>();
    let metric = scene.metrics::<T, D>()[0];
    let p = formed(&metric);
    let eigen = SymmetricEigen::new(DMatrix::from_fn(D, D, |row, column| p[(row, column)]));
    let dt = scene.dt::<T>().min(T::one());
    let fading = eigen.eigenvalues.map(|rate| (-rate * 3.0 * dt.as_f64()).exp());
    let propagator = &eigen.eigenvectors * DMatrix::from_diagonal(&fading) * eigen.eigenvectors.transpose();
    let offset = (start - goal).map(Real::as_f64);
    let known = goal.map(Real::as_f64)
        + SVector::<f64, D>::from_fn(|row, _| (0..D).map(|k| propagator[(row, k)] * offset[k]).sum());
    let scale = start.amax().max(goal.amax()).max(T::one());
    let precise = DormandPrince::new(T::rounded(1e3) * T::EPSILON * scale).unwrap();
    let flow = NaturalGradientFlow::new(attractor, metric);
    let path = rollout(&flow, &precise, start, dt, 3).unwrap();
    let error = (path[3].map(Real::as_f64) - known).norm();
    let allowed = 1e5 * (T::EPSILON * scale).as_f64();
    prop_assert!(error <= allowed, "{error} off at scale {scale}");
    Ok(())
}
for_every_space!(follows_the_matrix_exponential, well_conditioned_scene);

fn decreases_or_reports_stiffness<T: Real, const D: usize>(scene: &SceneDraw) -> TestCaseResult {
    let (attractor, start) = (scene.attractor::<T, D>(), scene.start::<T, D>());
    let size = start.amax().max(attractor.goal().amax()).max(T::one());
    let coarse = DormandPrince::new(size * T::rounded(1e-2)).unwrap();
    let metric = scene.metrics::<T, D>()[0];
    let flow = NaturalGradientFlow::new(attractor, metric);
    match rollout(&flow, &coarse, start, scene.dt(), 3) {
        Ok(path) => {
            let certificate = LyapunovCertificate::of_rollout(&flow, &path, scene.dt()).unwrap();
            prop_assert_eq!(certificate.verify(), Ok(()));
        }
        Err(DynamicsError::Step { cause, .. }) => {
            prop_assert!(matches!(*cause, DynamicsError::TooStiff { .. }), "{cause}");
        }
        Err(error) => prop_assert!(false, "{error}"),
    }
    Ok(())
}
for_every_space!(decreases_or_reports_stiffness, any_scene);

#[test]
fn agrees_with_ten_thousand_stable_steps() {
    let attractor = Attractor::new(Vector2::new(4.0, 1.5)).unwrap();
    let source = |state: &State<'_, f64, 2>| {
        CholeskyMetric::planar(1.1, 0.6 - 0.1 * state.time, 0.8 + 0.1 * state.position.y, 1e-8)
    };
    let flow = NaturalGradientFlow::new(attractor, source);
    let precise = DormandPrince::new(1e-10).unwrap();
    let path = rollout(&flow, &precise, Vector2::zeros(), 0.4, 5).unwrap();
    let fine = rollout(&flow, &StableEuler, Vector2::zeros(), 2e-4, 10_000).unwrap();
    let (one, other) = (path[5], fine[10_000]);
    assert!((one - other).norm() < 1e-4, "{one} {other}");
}

#[test]
fn an_invalid_tolerance_is_refused() {
    for tolerance in [0.0, -1e-9, f64::NAN, f64::INFINITY] {
        let error = DormandPrince::new(tolerance).unwrap_err();
        assert!(error.to_string().starts_with("the tolerance is"));
    }
}
