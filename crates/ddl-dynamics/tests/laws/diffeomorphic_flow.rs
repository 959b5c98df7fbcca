//! Flows transformed by a diffeomorphism: they turn around corners and stay stable.

use ddl_dynamics::{
    Chain, CholeskyMetric, DiffeomorphicFlow, DormandPrince, Flow, Integrator, LyapunovCertificate, MetricSchedule,
    Real, StableEuler, State, rollout,
};
use nalgebra::{ComplexField, SVector, Vector2};
use proptest::{prelude::*, test_runner::TestCaseResult};

use crate::{
    draw::{METRICS, SceneDraw},
    for_every_space,
    map_draw::MapDraw,
};

type Bent<T, const D: usize> = DiffeomorphicFlow<T, D, Chain<T, D>, MetricSchedule<T, D>>;

/// The flow of the scene's metrics to the first position of the maps, given in space and in the chart.
fn flows<T: Real, const D: usize>((maps, scene): &(MapDraw, SceneDraw)) -> [Bent<T, D>; 2] {
    let (goal, psi) = (maps.positions()[0], maps.chain());
    let metrics = MetricSchedule::new(scene.metrics()).unwrap();
    [
        DiffeomorphicFlow::new(goal, psi.clone(), metrics.clone()).unwrap(),
        DiffeomorphicFlow::in_chart(goal, psi, metrics).unwrap(),
    ]
}

/// For every map, metric, start and time step: the computed `V` falls in every step, or the pedestrian is on the goal.
fn the_certificate_holds_in_the_chart<T: Real, const D: usize>(draw: &(MapDraw, SceneDraw)) -> TestCaseResult {
    let dt = draw.1.dt();
    for flow in flows::<T, D>(draw) {
        for start in draw.0.positions() {
            let path = rollout(&flow, &StableEuler, start, dt, METRICS).unwrap();
            let certificate = LyapunovCertificate::of_rollout(&flow, &path, dt).unwrap();
            prop_assert_eq!(certificate.verify(), Ok(()));
            let potentials = path.iter().map(|position| flow.potential(position));
            prop_assert!(certificate.potentials().eq(potentials));
        }
    }
    Ok(())
}
for_every_space!(the_certificate_holds_in_the_chart, any_bent_scene);

/// `J v = -P u` in the chart, with the metric that the flow has there, and `u^T P u > 0`.
fn velocity_and_metric_agree<T: Real, const D: usize>(draw: &(MapDraw, SceneDraw)) -> TestCaseResult {
    for flow in flows::<T, D>(draw) {
        let psi = flow.chart().unwrap();
        for position in draw.0.positions() {
            let state = State::at(position);
            let (image, jacobian) = psi.apply_with_jacobian(&position);
            let u = flow.attractor().gradient(&image);
            let metric = flow.metric(&state).unwrap();
            let seen = jacobian * flow.velocity(&state).unwrap();
            // Neither side loses more digits than forming J P J^T and applying J^-1 and J.
            let stretch = jacobian.norm() * (T::one() + jacobian.try_inverse().unwrap().norm());
            let given = draw.1.metrics::<T, D>()[0].eigenvalue_range().largest;
            let scale = (given + metric.eigenvalue_range().largest) * (T::one() + stretch * stretch);
            let difference = (seen + metric.apply(&u)).norm();
            prop_assert!(difference <= T::rounded(256.0) * T::EPSILON * scale);
            prop_assert!(u == SVector::<T, D>::zeros() || metric.quadratic_form(&u) > T::zero());
        }
    }
    Ok(())
}
for_every_space!(velocity_and_metric_agree, any_bent_scene);

fn no_finite_input_breaks_a_bent_flow<T: Real, const D: usize>(draw: &(MapDraw, SceneDraw)) -> TestCaseResult {
    let (maps, scene) = draw;
    let psi = maps.chain::<T, D>();
    let metric = scene.metrics::<T, D>()[0];
    for goal in maps.positions().into_iter().take(2) {
        let made = [
            DiffeomorphicFlow::new(goal, psi.clone(), metric),
            DiffeomorphicFlow::in_chart(goal, psi.clone(), metric),
        ];
        for flow in made.into_iter().flatten() {
            for start in maps.positions() {
                let before = flow.potential(&start);
                let Ok(next) = StableEuler.step(&flow, &State::at(start), scene.dt()) else {
                    continue;
                };
                prop_assert!(next.iter().all(ComplexField::is_finite));
                prop_assert!(flow.potential(&next) < before || before.is_zero());
            }
        }
    }
    Ok(())
}
for_every_space!(no_finite_input_breaks_a_bent_flow, wild_bent_scene);

#[test]
fn a_detour_is_straight_in_the_chart_and_survives_a_metric() {
    let shown = [[0.0, 0.0], [3.0, 0.0], [3.0, 1.0], [0.0, 1.0]].map(Vector2::from);
    let (start, goal) = (shown[0], shown[3]);
    let psi = Chain::straightening(&shown, 150).unwrap().chain;
    let identity = CholeskyMetric::identity();
    let straight = DiffeomorphicFlow::in_chart(goal, psi.clone(), identity).unwrap();
    let precise = DormandPrince::new(1e-6).unwrap();
    for path in [
        rollout(&straight, &StableEuler, start, 0.4, 30).unwrap(),
        rollout(&straight, &precise, start, 0.4, 30).unwrap(),
    ] {
        let certificate = LyapunovCertificate::of_rollout(&straight, &path, 0.4).unwrap();
        assert_eq!(certificate.verify(), Ok(()));
        assert!(certificate.largest_angle() < 0.017);
        assert!(path.iter().any(|p| p.x > 2.5) && (path[30] - goal).norm() < 1e-12);
    }
    let leaning = CholeskyMetric::planar(1.1, 0.3, 0.9, 1e-8).unwrap();
    let leaning = DiffeomorphicFlow::new(goal, psi, leaning).unwrap();
    let path = rollout(&leaning, &StableEuler, start, 0.05, 4000).unwrap();
    let moves = path.windows(2);
    let turns = moves.map(|pair| (pair[1] - pair[0]).angle(&(goal - pair[0])));
    assert!(turns.fold(0.0, f64::max) > 100_f64.to_radians());
    assert!((path[4000] - goal).norm() < 1e-6);
}

#[test]
fn a_goal_without_an_image_is_refused() {
    let (goal, psi) = (Vector2::new(f64::NAN, 0.0), Chain::new(Vec::new()));
    let metric = CholeskyMetric::<f64, 2>::identity();
    let error = DiffeomorphicFlow::new(goal, psi, metric).unwrap_err();
    assert!(
        error.to_string().starts_with("component 0 of the goal is NaN"),
        "{error}"
    );
}
