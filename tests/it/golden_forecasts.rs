//! Forecasts of the built-in models as libtorch computed them, before there were kernels for all of the network: goals,
//! weights and positions of a scene made up for this purpose (`tests/golden`).

use ddl::data::{PedestrianId, Position, Window};
use ddl::eval::Forecast;
use ddl::{BuiltinModel, Ddl, DeviceChoice, Forecaster as _};
use serde::Deserialize;
use std::collections::BTreeMap;

/// Positions differ by rounding in single precision; metres.
const OFF: f64 = 1e-4;
/// So do weights, and places of goals.
const LITTLE: f64 = 1e-5;

/// What was forecast of one pedestrian; positions in metres.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Golden {
    pedestrian: i64,
    familiarity: f64,
    /// The last position of the one forecast.
    one: Position,
    weights: Vec<f64>,
    goals: Vec<Position>,
    step_1: Vec<Position>,
    step_6: Vec<Position>,
}

fn golden() -> BTreeMap<String, Vec<Golden>> {
    serde_json::from_str(include_str!("../golden/forecasts.json")).unwrap()
}

/// Ten pedestrians: side by side, head on, turning, standing, running, slowing down, trembling, far from all.
fn window() -> Window {
    let mut tracks: BTreeMap<i64, Vec<Position>> = BTreeMap::new();
    for row in include_str!("../golden/tracks.csv").lines().skip(1) {
        let fields: Vec<f64> = row.split(',').map(|field| field.parse().unwrap()).collect();
        let track = tracks.entry(fields[1] as i64).or_default();
        track.push([fields[2], fields[3]]);
    }
    let pedestrians = tracks.keys().map(|&id| PedestrianId(id)).collect();
    Window::new("golden", 0, 10, pedestrians, tracks.into_values().collect()).unwrap()
}

fn near(a: Position, b: Position, off: f64) -> bool {
    (a[0] - b[0]).hypot(a[1] - b[1]) <= off
}

fn check(model: BuiltinModel, golden: &[Golden], forecast: &Forecast, one: &Forecast) {
    for (i, golden) in golden.iter().enumerate() {
        let name = format!("{model}, pedestrian {}", golden.pedestrian);
        assert!(
            near(one.hypothesis(i, 0)[11], golden.one, OFF),
            "{name}: one"
        );
        let mut order: Vec<usize> = (0..forecast.hypotheses()).collect();
        order.sort_by(|&a, &b| forecast.weight(i, b).total_cmp(&forecast.weight(i, a)));
        assert_eq!(order.len(), golden.weights.len(), "{name}");
        for (k, h) in order.into_iter().enumerate() {
            let weight = forecast.weight(i, h);
            assert!(
                (weight - golden.weights[k]).abs() < LITTLE,
                "{name}: {weight}"
            );
            let path = forecast.hypothesis(i, h);
            for (t, known, off) in [
                (0, golden.step_1[k], OFF),
                (5, golden.step_6[k], OFF),
                (11, golden.goals[k], LITTLE + OFF),
            ] {
                assert!(
                    near(path[t], known, off),
                    "{name}, {k}: {:?} {known:?}",
                    path[t]
                );
            }
            let goal = forecast.goal(i, h).unwrap();
            assert!(
                near(goal, golden.goals[k], LITTLE),
                "{name}, goal {k}: {goal:?}"
            );
        }
    }
}

#[test]
fn built_in_models_forecast_as_libtorch_did() {
    let (golden, window) = (golden(), window());
    for model in BuiltinModel::ALL {
        let loaded = Ddl::builtin(model, DeviceChoice::Cpu).unwrap();
        let golden = &golden[model.name()];
        assert_eq!(golden.len(), window.len());
        for (found, known) in loaded.goal_model().familiarity(&window).iter().zip(golden) {
            assert!((found - known.familiarity).abs() < 1e-9);
        }
        let forecast = loaded.forecast(&window).unwrap();
        let one = loaded.forecast_one(std::slice::from_ref(&window)).unwrap();
        check(model, golden, &forecast, &one[0]);
    }
}
