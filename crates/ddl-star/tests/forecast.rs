//! Forecasts of whole windows: where they may be, and what they refuse.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use ddl_data::{Dataset, Position, Window, WindowRule};
use ddl_star::{
    ComputeDevice, DeviceChoice, Noise, StarConfig, StarError, StarNetwork, StepRule, Variant,
};

fn network(variant: Variant) -> StarNetwork {
    ddl_star::set_threads(1);
    let device = ComputeDevice::open(DeviceChoice::Cpu).unwrap();
    StarNetwork::new(StarConfig::published(variant), 5, device).unwrap()
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
    for variant in Variant::ALL {
        let network = network(variant);
        let forecast = |windows: &[Window], goals: &[Vec<Vec<Position>>]| {
            network
                .forecast_windows(windows, goals, Noise::Expected, StepRule::StableEuler)
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

#[test]
fn goals_that_do_not_fit_the_windows_are_refused() {
    let (windows, goals) = scene();
    let network = network(Variant::Full);
    let refuse = |goals: &[Vec<Vec<Position>>], noise: Noise| {
        let error = network
            .forecast_windows(&windows, goals, noise, StepRule::Euler)
            .unwrap_err();
        assert!(matches!(error, StarError::Shape { .. }), "{error}");
    };
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
