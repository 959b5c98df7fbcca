//! Goals of `ddl-goal`, followed by the flows of `ddl-dynamics`, scored by `ddl-eval`: what the
//! certificate of a rollout says, the stability scores must say as well.

use ddl_data::{HORIZON, OBSERVED, Position, TIME_STEP, Window};
use ddl_dynamics::{
    Attractor, CholeskyMetric, Euler, Integrator, LyapunovCertificate, NaturalGradientFlow,
    StableEuler, rollout,
};
use ddl_eval::metric::stability::RolloutStability;
use ddl_eval::{Forecast, Scores};
use ddl_goal::{GoalEstimator, GoalEstimatorParams};
use ddl_tests::crowd;
use nalgebra::Vector2;

type Metric = CholeskyMetric<f64, 2>;

/// 12 steps of a flow that leans to one side of the way to the goal, and what its certificate says.
fn walk(
    start: Position,
    goal: Position,
    metric: Metric,
    integrator: &impl Integrator<f64, 2>,
) -> (Vec<Position>, bool) {
    let attractor = Attractor::new(Vector2::from(goal)).unwrap();
    let flow = NaturalGradientFlow::new(attractor, metric);
    let path = rollout(&flow, integrator, Vector2::from(start), TIME_STEP, HORIZON).unwrap();
    let metrics = vec![metric; HORIZON];
    let certificate = LyapunovCertificate::new(&path, &metrics, &attractor, TIME_STEP).unwrap();
    let positions = path[1..].iter().map(|&p| p.into()).collect();
    (positions, certificate.holds().is_ok())
}

/// A forecast of the flow to every estimated goal, with how many of its rollouts are certified.
fn forecast(
    window: &Window,
    estimator: &GoalEstimator,
    metric: Metric,
    integrator: &impl Integrator<f64, 2>,
) -> (Forecast, usize) {
    let (mut positions, mut weights, mut goals) = (Vec::new(), Vec::new(), Vec::new());
    let mut certified = 0;
    for i in 0..window.len() {
        let set = estimator.estimate(window.observed(i)).unwrap();
        let start = window.observed(i)[OBSERVED - 1];
        for &goal in set.goals() {
            let (path, holds) = walk(start, goal, metric, integrator);
            let judged = RolloutStability::of(start, &path, goal);
            // within a millimetre of the goal the scores look no closer
            assert!(
                judged.decreasing || !holds,
                "certified, yet scored unstable"
            );
            certified += usize::from(holds);
            positions.extend(path);
        }
        weights.extend_from_slice(set.weights());
        goals.extend_from_slice(set.goals());
    }
    let hypotheses = estimator.params().clusters;
    let forecast =
        Forecast::new(window.len(), hypotheses, positions, weights, Some(goals)).unwrap();
    (forecast, certified)
}

/// The share of stable rollouts as scored, and as certified.
fn shares(metric: Metric, integrator: &impl Integrator<f64, 2>) -> (f64, f64) {
    let estimator = crowd::goal_estimator(GoalEstimatorParams::default());
    let windows = crowd::windows(5, 8);
    let (forecasts, certified): (Vec<_>, Vec<_>) = windows
        .iter()
        .map(|window| forecast(window, &estimator, metric, integrator))
        .unzip();
    let stability = Scores::evaluate(&windows, &forecasts)
        .unwrap()
        .stability
        .unwrap();
    let certified: usize = certified.iter().sum();
    (
        stability.decreasing,
        certified as f64 / stability.rollouts as f64,
    )
}

#[test]
fn stable_steps_are_certified_and_scored_stable_all() {
    for metric in [
        CholeskyMetric::planar(1.2, 0.5, 0.9, 1e-8).unwrap(),
        CholeskyMetric::planar(4.0, -3.0, 0.1, 1e-8).unwrap(), // far too fast for its time step
    ] {
        assert_eq!(shares(metric, &StableEuler), (1.0, 1.0));
    }
}

#[test]
fn published_steps_that_overshoot_are_scored_unstable() {
    let too_fast = CholeskyMetric::planar(4.0, -3.0, 0.1, 1e-8).unwrap();
    let (scored, certified) = shares(too_fast, &Euler);
    assert!(
        scored < 0.5 && certified < 0.5,
        "{scored} scored, {certified} certified"
    );
    assert!((scored - certified).abs() < 1e-12);
}
