//! Golden forecasts of a synthetic scene, stored in the repository (`tests/golden`).

use ddl::data::{PedestrianId, Position, Window};
use ddl::{BuiltinModel, Ddl, Request};
use ddl_core::distance;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Allowed difference of positions (m), due to rounding in single precision ...
const OFF: f64 = 1e-4;
/// ... and of weights and goals.
const LITTLE: f64 = 1e-5;

/// The forecast of one pedestrian; positions in metres, the most likely hypothesis first.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Golden {
    pedestrian: i64,
    familiarity: f64,
    /// The last position of the single forecast.
    one: Position,
    weights: Vec<f64>,
    goals: Vec<Position>,
    step_1: Vec<Position>,
    step_6: Vec<Position>,
}

/// Panics unless the forecasts of every built-in model agree with the stored ones.
pub fn check(forecasts: impl Fn(BuiltinModel) -> Vec<Golden>) {
    let file = include_str!("../golden/forecasts.json");
    let stored: BTreeMap<String, Vec<Golden>> = serde_json::from_str(file).expect("the file is valid");
    for model in BuiltinModel::ALL {
        let (computed, stored) = (forecasts(model), &stored[model.name()]);
        assert_eq!(computed.len(), stored.len());
        for (computed, stored) in computed.iter().zip(stored) {
            computed.assert_near(stored, model.name());
        }
    }
}

/// Ten pedestrians: side by side, head on, turning, standing, running, slowing down, noisy, far from all others.
pub fn window() -> Window {
    let mut tracks: BTreeMap<i64, Vec<Position>> = BTreeMap::new();
    for row in include_str!("../golden/tracks.csv").lines().skip(1) {
        let fields: Vec<f64> = row.split(',').map(|field: &str| field.parse::<f64>().expect("a number")).collect();
        tracks.entry(fields[1] as i64).or_default().push([fields[2], fields[3]]);
    }
    let pedestrians = tracks.keys().map(|&id| PedestrianId(id)).collect();
    Window::new("golden", 0, 10, pedestrians, tracks.into_values().collect()).expect("a window")
}

impl Golden {
    /// The forecasts of a model, rounded as in the file.
    pub fn of(model: &Ddl) -> Vec<Self> {
        let window = window();
        let [forecast, one] = [Request::default(), Request::one()].map(|request| {
            model.forecast(std::slice::from_ref(&window), &request).expect("a forecast").remove(0).into_forecast()
        });
        let familiarity = model.goal_model().familiarity(&window);
        let of_pedestrian = |i: usize| {
            let mut order: Vec<usize> = (0..forecast.hypotheses()).collect();
            order.sort_by(|&a, &b| forecast.weight(i, b).total_cmp(&forecast.weight(i, a)));
            let rounded_of = |position: &dyn Fn(usize) -> Position| -> Vec<Position> {
                order.iter().map(|&h| position(h).map(|x| rounded(x, 7))).collect()
            };
            let weight = |&h: &usize| rounded(forecast.weight(i, h), 9);
            Self {
                pedestrian: window.pedestrians()[i].0,
                familiarity: rounded(familiarity[i], 9),
                one: one.hypothesis(i, 0)[11].map(|x| rounded(x, 7)),
                weights: order.iter().map(weight).collect(),
                goals: rounded_of(&|h| forecast.goal(i, h).expect("a goal")),
                step_1: rounded_of(&|h| forecast.hypothesis(i, h)[0]),
                step_6: rounded_of(&|h| forecast.hypothesis(i, h)[5]),
            }
        };
        (0..window.len()).map(of_pedestrian).collect()
    }

    /// Panics, naming the difference, unless both agree up to rounding.
    fn assert_near(&self, stored: &Self, model: &str) {
        let name = format!("{model}, pedestrian {}", stored.pedestrian);
        assert_eq!(self.pedestrian, stored.pedestrian, "{name}");
        assert!((self.familiarity - stored.familiarity).abs() < 1e-9, "{name}");
        assert!(distance(self.one, stored.one) <= OFF, "{name}: one");
        assert_eq!(self.weights.len(), stored.weights.len(), "{name}");
        for k in 0..stored.weights.len() {
            let (computed, expected) = (self.weights[k], stored.weights[k]);
            assert!((computed - expected).abs() < LITTLE, "{name}, weight {k}: {computed} {expected}");
            for (what, computed, expected, off) in [
                ("goal", &self.goals, &stored.goals, LITTLE),
                ("step 1", &self.step_1, &stored.step_1, OFF),
                ("step 6", &self.step_6, &stored.step_6, OFF),
            ] {
                let (computed, expected) = (computed[k], expected[k]);
                let near = distance(computed, expected) <= off;
                assert!(near, "{name}, {what} {k}: {computed:?} {expected:?}");
            }
        }
    }
}

fn rounded(number: f64, decimals: i32) -> f64 {
    let unit = 10.0_f64.powi(decimals);
    (number * unit).round() / unit
}
