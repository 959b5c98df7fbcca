//! Forecasts of whole windows: where they may be, and what they refuse.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use ddl_data::{Dataset, HORIZON, OBSERVED, Position, Window, WindowRule};
use ddl_dynamics::{
    Attractor, CholeskyMetric, Euler, NaturalGradientFlow, StableEuler, StepTime, rollout,
};
use ddl_network::{
    DeviceChoice, ForecastWindows, MotionNetwork, NetworkError, Noise, StarConfig, StepRule,
    Variant, motion_bounds,
};
use ddl_star::{ComputeDevice, TorchNetwork};
use nalgebra::Vector2;

/// The plain network and that of libtorch.
fn networks(variant: Variant) -> [Box<dyn ForecastWindows>; 2] {
    ddl_star::set_threads(1);
    let device = ComputeDevice::open(DeviceChoice::Cpu).unwrap();
    let config = StarConfig::published(variant);
    let torch = TorchNetwork::new(config.clone(), 5, device).unwrap();
    let plain = MotionNetwork::new(config, 5).unwrap();
    [Box::new(plain), torch.into_forecaster()]
}

/// Observed windows of a simulated scene, and three goals for everybody.
fn scene() -> (Vec<Window>, Vec<Vec<Vec<Position>>>) {
    let dataset = Dataset::simulated(1);
    let windows = dataset.recordings()[0].windows(WindowRule::Complete);
    let windows: Vec<Window> = windows
        .iter()
        .skip(20)
        .take(6)
        .map(Window::without_future)
        .collect();
    let around = |p: Position| vec![[p[0] + 3.0, p[1]], [p[0], p[1] - 2.0], p];
    let goals = windows
        .iter()
        .map(|window| {
            (0..window.len())
                .map(|i| around(window.observed(i)[7]))
                .collect()
        })
        .collect();
    (windows, goals)
}

/// In map coordinates f32 resolves half a metre: positions must be taken relative to the scene first.
#[test]
fn forecasts_move_with_the_scene_even_to_map_coordinates() {
    let (windows, goals) = scene();
    let offset = [691_608.0, 5_334_763.0]; // a city in metres, as maps have it
    let shift = |p: Position| [p[0] + offset[0], p[1] + offset[1]];
    let far: Vec<Window> = windows
        .iter()
        .map(|window| window.map_positions(|_, _, p| shift(p)))
        .collect();
    let far_goals: Vec<Vec<Vec<Position>>> = goals
        .iter()
        .map(|goals| {
            goals
                .iter()
                .map(|goals| goals.iter().map(|&goal| shift(goal)).collect())
                .collect()
        })
        .collect();
    for network in Variant::ALL.into_iter().flat_map(networks) {
        let variant = network.config().variant;
        let forecast = |windows: &[Window], goals: &[Vec<Vec<Position>>]| {
            network
                .forecast_windows(windows, goals, Noise::Expected, StepRule::Bounded, None)
                .unwrap()
        };
        for (near, far) in forecast(&windows, &goals)
            .iter()
            .zip(forecast(&far, &far_goals))
        {
            assert_eq!(near.positions.len(), far.positions.len());
            for (&near, far) in near.positions.iter().zip(far.positions) {
                let near = shift(near);
                let distance = (near[0] - far[0]).hypot(near[1] - far[1]);
                assert!(distance < 1e-3, "{variant}: {distance} m apart");
            }
        }
    }
}

fn distance(a: Position, b: Position) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// Step `done` of `ddl-dynamics` in f64, with an emitted factor, of a pedestrian that was observed so.
fn step(
    (from, goal): (Position, Position),
    [a, b, c]: [f64; 3],
    rule: StepRule,
    (observed, done): (&[Position], usize),
) -> Position {
    let config = StarConfig::published(Variant::Full);
    let (start, dt): (Vector2<f64>, f64) = (from.into(), config.time_step);
    let attractor = Attractor::new(goal.into()).unwrap();
    let metric = CholeskyMetric::planar(a, b, c, config.sigma).unwrap();
    match rule {
        StepRule::Euler => rollout(
            &NaturalGradientFlow::new(attractor, metric),
            &Euler,
            start,
            dt,
            1,
        ),
        StepRule::Bounded => {
            let left = HORIZON - done;
            let towards = attractor.goal() - start;
            let bounds = motion_bounds(observed, dt, 1.0).absolute(); // of the published frame
            let metric = bounds.shape(&metric, &towards, StepTime { done, left, dt });
            rollout(
                &NaturalGradientFlow::new(attractor, metric),
                &StableEuler,
                start,
                dt,
                1,
            )
        }
    }
    .unwrap()[1]
        .into()
}

/// Each position follows from the one before it by the factor that stands beside it.
#[test]
fn the_factors_are_those_of_the_steps() {
    let (windows, goals) = scene();
    let shaped = [Variant::Full, Variant::NoGoalShift];
    for network in shaped.into_iter().flat_map(networks) {
        let variant = network.config().variant;
        for rule in [StepRule::Euler, StepRule::Bounded] {
            let mut compared = 0;
            let rollouts = network
                .forecast_windows(&windows, &goals, Noise::Expected, rule, None)
                .unwrap();
            for ((window, goals), rollout) in windows.iter().zip(&goals).zip(&rollouts) {
                let factors = rollout.factors.as_ref().unwrap();
                assert_eq!(factors.len(), rollout.positions.len());
                assert_eq!(factors.len(), window.len() * 3 * HORIZON);
                let paths = rollout.positions.chunks_exact(HORIZON);
                let shaped = paths.zip(factors.chunks_exact(HORIZON));
                for (pair, (path, factors)) in shaped.enumerate() {
                    let (i, k) = (pair / 3, pair % 3);
                    let mut here = window.observed(i)[OBSERVED - 1];
                    for (done, (&next, &factor)) in path.iter().zip(factors).enumerate() {
                        let goal = goals[i][k];
                        let seen = (window.observed(i), done);
                        let expected = step((here, goal), factor, rule, seen);
                        let off = distance(next, expected);
                        // next to the goal, rounding decides where a plain step leads to
                        let undecided = rule == StepRule::Euler && distance(here, goal) < 1e-2;
                        assert!(off < 1e-4 || undecided, "{variant}, {rule:?}: {off} m off");
                        compared += usize::from(!undecided);
                        here = next;
                    }
                }
            }
            let walkers: usize = windows.iter().map(Window::len).sum();
            assert!(
                compared > walkers * 3 * HORIZON / 2,
                "{compared} steps compared"
            );
        }
    }
    let positions = [Variant::NoDynamics, Variant::Star];
    for network in positions.into_iter().flat_map(networks) {
        let rollouts = network
            .forecast_windows(&windows, &goals, Noise::Expected, StepRule::Bounded, None)
            .unwrap();
        assert!(rollouts.iter().all(|rollout| rollout.factors.is_none()));
    }
}

#[test]
fn goals_that_do_not_fit_the_windows_are_refused() {
    let (windows, goals) = scene();
    let [network, _] = networks(Variant::Full);
    let refuse = |goals: &[Vec<Vec<Position>>], noise: Noise| {
        let error = network
            .forecast_windows(&windows, goals, noise, StepRule::Euler, None)
            .unwrap_err();
        assert!(matches!(error, NetworkError::Shape { .. }), "{error}");
    };
    let shares = vec![vec![1.0]; windows.len() + 1];
    let error = network
        .forecast_windows(
            &windows,
            &goals,
            Noise::Expected,
            StepRule::Bounded,
            Some(&shares),
        )
        .unwrap_err();
    assert!(matches!(error, NetworkError::Shape { .. }), "{error}");
    refuse(&goals[1..], Noise::Expected);
    refuse(&goals, Noise::Draws { count: 2, seed: 1 });
    refuse(&goals, Noise::Draws { count: 0, seed: 1 });
    let mut uneven = goals.clone();
    uneven[2][0].pop();
    refuse(&uneven, Noise::Expected);
    uneven = goals.clone();
    uneven[1].pop();
    refuse(&uneven, Noise::Expected);
}
