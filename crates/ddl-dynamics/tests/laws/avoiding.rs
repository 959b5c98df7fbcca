//! Obstacles change the path, but the goal is still reached.

use ddl_dynamics::{
    Attractor, AvoidingFlow, Ball, CholeskyMetric, Flow, LyapunovCertificate, NaturalGradientFlow, ObstacleSchedule,
    Real, StableEuler, rollout,
};
use nalgebra::{Matrix2, Rotation2, Vector2};
use proptest::{collection::vec, prelude::*, test_runner::TestCaseResult};

use crate::{
    draw::{SceneDraw, at},
    for_every_space,
};

fn straight_to(goal: Vector2<f64>) -> NaturalGradientFlow<f64, 2, CholeskyMetric<f64, 2>> {
    NaturalGradientFlow::new(Attractor::new(goal).unwrap(), CholeskyMetric::identity())
}

/// Balls along the path of the scene: two that stay in place, one on the goal, one on the start.
fn balls<T: Real, const D: usize>(scene: &SceneDraw) -> Vec<Ball<T, D>> {
    let (start, goal) = (scene.start::<T, D>(), *scene.attractor::<T, D>().goal());
    let (aside, span) = (scene.direction::<T, D>(), (start - goal).norm());
    [(0.3, 0.1), (0.6, 0.2), (1.0, 0.05), (0.0, 0.05)]
        .into_iter()
        .map(|(along, radius)| {
            let centre = start + (goal - start) * T::rounded(along) + aside;
            Ball::new(centre, span * T::rounded(radius) + T::rounded(1e-3)).unwrap()
        })
        .collect()
}

/// The certificate holds for all obstacles, starts and time steps. A pedestrian outside the balls stays outside, up to
/// rounding. On a surface, a share epsilon of its speed may still point inwards, which is visible at a million metres
/// per second.
fn the_distance_falls_and_no_ball_is_entered<T: Real, const D: usize>(scene: &SceneDraw) -> TestCaseResult {
    let start = scene.start::<T, D>();
    let metrics: Vec<CholeskyMetric<T, D>> = scene.metrics();
    let path = |balls: Vec<Ball<T, D>>| {
        let flow = AvoidingFlow::new(scene.flow(), balls, T::rounded(0.5)).unwrap();
        let path = rollout(&flow, &StableEuler, start, scene.dt(), 12).unwrap();
        let certificate = LyapunovCertificate::of_rollout(&flow, &path, scene.dt()).unwrap();
        prop_assert_eq!(certificate.verify(), Ok(()));
        Ok(path)
    };
    let mut balls = balls::<T, D>(scene);
    path(balls.clone())?;
    balls.retain(|ball| ball.gap_and_normal(&start).0 > T::zero());
    let path = path(balls.clone())?;
    let far = path.iter().map(nalgebra::Matrix::amax).fold(T::zero(), T::max);
    let noise = T::rounded(64.0) * T::EPSILON * far.max(T::one());
    for ball in &balls {
        let mut deepest = -noise;
        for (step, metric) in path.windows(2).zip(&metrics) {
            let [before, after] = [0, 1].map(|t| ball.gap_and_normal(&step[t]).0);
            if before <= noise {
                let speed = metric.eigenvalue_range().largest;
                deepest -= T::rounded(2.0) * T::EPSILON * speed * scene.dt();
            }
            prop_assert!(after >= deepest, "{before:?} m to {after:?} m from {ball:?}");
        }
    }
    Ok(())
}
for_every_space!(the_distance_falls_and_no_ball_is_entered, any_scene);

/// Centre and radius (m).
type Pillar = (Vector2<f64>, f64);

fn ball(&(centre, radius): &Pillar) -> Ball<f64, 2> {
    Ball::new(centre, radius).unwrap()
}

/// Pillars at least 2 cm apart, none of them on the goal at the origin, a pedestrian outside them, a metric with a
/// condition number up to 20, and a margin.
fn park() -> impl Strategy<Value = (Vec<Pillar>, Vector2<f64>, CholeskyMetric<f64, 2>, f64)> {
    let place = || (-6.0..6.0_f64, -6.0..6.0_f64).prop_map(|(x, y)| Vector2::new(x, y));
    let factor = (-0.7..0.0_f64, 0.0..std::f64::consts::PI);
    (vec((place(), 0.2..1.5_f64), 0..14), place(), factor, 0.3..3.0_f64).prop_map(
        |(pillars, start, (slow, turn), margin)| {
            let mut pillars_apart: Vec<Pillar> = Vec::new();
            for pillar in pillars {
                let clear = |point: &Vector2<f64>, gap| ball(&pillar).gap_and_normal(point).0 > gap;
                let apart = |(centre, radius): &Pillar| clear(centre, radius + 0.02);
                if clear(&start, 0.02) && clear(&Vector2::zeros(), 0.05) && pillars_apart.iter().all(apart) {
                    pillars_apart.push(pillar);
                }
            }
            let turn = Rotation2::new(turn);
            let diagonal = Matrix2::from_diagonal(&Vector2::new(1.0, 10_f64.powf(2.0 * slow)));
            let turned = turn * diagonal * turn.inverse();
            let metric = CholeskyMetric::new(turned.cholesky().unwrap().l(), 1e-8).unwrap();
            (pillars_apart, start, metric, margin)
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    #[test]
    fn every_pedestrian_arrives((pillars, start, metric, margin) in park()) {
        let origin = Attractor::new(Vector2::zeros()).unwrap();
        let pedestrian = NaturalGradientFlow::new(origin, metric);
        let pillars: Vec<Ball<f64, 2>> = pillars.iter().map(ball).collect();
        let flow = AvoidingFlow::new(pedestrian, pillars.clone(), margin).unwrap();
        let path = rollout(&flow, &StableEuler, start, 0.4, 20_000).unwrap();
        for pillar in &pillars {
            prop_assert!(path.iter().all(|p| pillar.gap_and_normal(p).0 > -1e-12));
        }
        prop_assert!(path[20_000].norm() < 1e-9, "{} m off", path[20_000].norm());
    }

    /// For any number of pillars nearby and beside any of them: the pedestrian moves away, or approaches at `sqrt(2
    /// share) lambda_max` at most.
    #[test]
    fn each_approach_is_slowed(
        (pillars, _, metric, margin) in park(),
        (exponent, angle) in (-9.0..-1.0_f64, 0.0..std::f64::consts::TAU),
    ) {
        let origin = Attractor::new(Vector2::zeros()).unwrap();
        let pedestrian = NaturalGradientFlow::new(origin, metric);
        let balls: Vec<Ball<f64, 2>> = pillars.iter().map(ball).collect();
        let flow = AvoidingFlow::new(pedestrian, balls.clone(), margin).unwrap();
        let outwards = Vector2::new(angle.cos(), angle.sin());
        for (centre, radius) in pillars {
            let place = centre + outwards * (radius + 10_f64.powf(exponent));
            let velocity = flow.velocity(&at(place)).unwrap();
            for pillar in &balls {
                let (gap, normal) = pillar.gap_and_normal(&place);
                let share = (gap / margin).max(f64::EPSILON);
                let largest = (2.0 * share).sqrt() * metric.eigenvalue_range().largest;
                prop_assert!(-normal.dot(&velocity) <= largest * (1.0 + 1e-6));
            }
        }
    }
}

#[test]
fn an_offset_that_overflows_is_handled() {
    let far = Ball::new(Vector2::new(-f64::MAX, 0.0), 1.0).unwrap();
    let pedestrian = straight_to(Vector2::new(0.9 * f64::MAX, 0.0));
    let flow = AvoidingFlow::new(pedestrian, [far], 1.0).unwrap();
    let start = Vector2::new(0.99 * f64::MAX, 0.0);
    let (gap, normal) = far.gap_and_normal(&start);
    assert_eq!((gap, normal), (f64::INFINITY, Vector2::new(1.0, 0.0)));
    assert!(rollout(&flow, &StableEuler, start, 0.4, 3).is_ok());
}

#[test]
fn the_velocity_is_continuous() {
    let attractor = Attractor::new(Vector2::new(5.0, 0.0)).unwrap();
    let metric = CholeskyMetric::planar(1.2, 0.7, 0.5, 1e-8).unwrap();
    let pedestrian = NaturalGradientFlow::new(attractor, metric);
    let pillar = Ball::new(Vector2::new(0.0, 0.0), 1.0).unwrap();
    let flow = AvoidingFlow::new(pedestrian, [pillar], 1.0).unwrap();
    // A circle around the pillar, in small steps: the velocity has no jump, even where the share is small.
    for gap in [1e-6, 0.3, 0.999] {
        let velocity = |k: u32| {
            let angle = f64::from(k) * std::f64::consts::TAU / 20_000.0;
            let place = Vector2::new(angle.cos(), angle.sin()) * (1.0 + gap);
            flow.velocity(&at(place)).unwrap()
        };
        let jump = (0..20_000).map(|k| (velocity(k + 1) - velocity(k)).norm());
        assert!(jump.fold(0.0, f64::max) < 2e-3);
    }
}

/// The saddle is exactly behind the pillar as seen from the goal: a pedestrian comes to rest there. A pedestrian that
/// starts slightly beside it passes.
#[test]
fn the_saddle_is_the_only_other_equilibrium() {
    let pedestrian = straight_to(Vector2::new(4.0, 0.0));
    let pillar = Ball::new(Vector2::new(2.0, 0.0), 0.5).unwrap();
    let flow = AvoidingFlow::new(pedestrian, [pillar], 0.5).unwrap();
    let held = rollout(&flow, &StableEuler, Vector2::zeros(), 0.1, 400).unwrap();
    assert!((held[400] - Vector2::new(1.5, 0.0)).norm() < 1e-6);
    assert!(pillar.gap_and_normal(&held[400]).0 > -1e-12);
    let free = rollout(&flow, &StableEuler, Vector2::new(0.0, 1e-6), 0.1, 400).unwrap();
    assert_eq!(free[400], Vector2::new(4.0, 0.0));
}

/// A pillar that exists only in the first steps: the pedestrian waits, then goes straight.
#[test]
fn obstacles_may_change_with_the_step() {
    let pedestrian = straight_to(Vector2::new(4.0, 0.0));
    let pillar = Ball::new(Vector2::new(1.5, 0.0), 0.5).unwrap();
    let schedule = ObstacleSchedule::new([vec![vec![pillar]; 10], vec![vec![]]].concat());
    let flow = AvoidingFlow::new(pedestrian, schedule, 1.0).unwrap();
    let path = rollout(&flow, &StableEuler, Vector2::zeros(), 0.4, 20).unwrap();
    assert!(path[10].x < 1.0 && path[11].x > path[10].x + 0.39);
    assert_eq!(path[20], Vector2::new(4.0, 0.0));
}

#[test]
fn invalid_obstacles_are_refused() {
    let centre = Vector2::new(0.0, 0.0);
    for radius in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let error = Ball::new(centre, radius).unwrap_err().to_string();
        assert!(error.starts_with("the radius of the obstacle is"), "{error}");
        let flow = straight_to(centre);
        let error = AvoidingFlow::new(flow, Vec::new(), radius).unwrap_err().to_string();
        assert!(error.starts_with("the margin around obstacles is"), "{error}");
    }
    assert!(Ball::new(Vector2::new(f64::NAN, 0.0), 1.0).is_err());
}
