//! Forecasts of the built-in models agree with those of libtorch (`it_torch/golden_forecasts.rs` updates them), and
//! their joint futures and risks with stored ones (with `DDL_WRITE_GOLDEN=1` they are stored anew).

use ddl::data::Position;
use ddl::scene::{Plan, PlanPoint};
use ddl::{BuiltinModel, Ddl, DeviceChoice, Request};
use ddl_core::distance;
use ddl_tests::golden::{self, Golden};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::Path;

#[test]
fn built_in_models_agree_with_libtorch() {
    golden::check(|model| Golden::of(&Ddl::builtin(model, DeviceChoice::Cpu).unwrap()));
}

/// The joint futures of the golden scene, and the answers about two plans.
#[derive(Serialize, Deserialize)]
struct GoldenScene {
    weights: Vec<f64>,
    /// Where each pedestrian ends in the likeliest future, metres.
    ends: Vec<Position>,
    /// Risk of each plan, if people see it and if not, and its expected least distance (m).
    risks: Vec<[f64; 3]>,
}

/// One plan through the middle of the scene, and one that waits beside it.
fn plans() -> Vec<Plan> {
    let point = |time, position, radius| PlanPoint { time, position, radius };
    let crossing = [point(0.0, [0.5, -3.0], 0.3), point(4.8, [6.0, 3.0], 0.4)];
    [crossing.to_vec(), vec![point(0.0, [3.0, 1.5], 0.2)]].map(|points| Plan::new(points).unwrap()).into()
}

impl GoldenScene {
    fn made_by(model: BuiltinModel) -> Self {
        let model = Ddl::builtin(model, DeviceChoice::Cpu).unwrap();
        let answer = model.forecast(&[golden::window()], &Request::joint()).unwrap().remove(0);
        let (futures, plans) = (answer.futures().unwrap(), plans());
        let [seen, unseen] = [futures.risks_if_seen(&plans, 0.5, None), futures.risks(&plans, 0.5, None)]
            .map(|risks| risks.unwrap().into_iter().map(|risk| risk.total));
        let nearest = futures.clearances(&plans).unwrap().into_iter().map(|clearance| clearance.nearest);
        let forecast = answer.forecast();
        let likeliest = forecast.most_likely(0);
        Self {
            weights: (0..forecast.hypotheses()).map(|k| forecast.weight(0, k)).collect(),
            ends: (0..forecast.pedestrians()).map(|i| forecast.hypothesis(i, likeliest)[11]).collect(),
            risks: seen.zip(unseen).zip(nearest).map(|((seen, unseen), nearest)| [seen, unseen, nearest]).collect(),
        }
    }
}

#[test]
fn joint_futures_and_risks_are_those_that_are_stored() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("golden/scenes.json");
    let models = BuiltinModel::ALL.map(|model| (model.name().to_owned(), GoldenScene::made_by(model)));
    let made = BTreeMap::from(models);
    if std::env::var_os("DDL_WRITE_GOLDEN").is_some() {
        std::fs::write(&path, serde_json::to_string(&made).unwrap() + "\n").unwrap();
    }
    let stored: BTreeMap<String, GoldenScene> = serde_json::from_slice(&std::fs::read(&path).unwrap()).unwrap();
    for (name, made) in &made {
        let stored = &stored[name];
        // Another processor rounds otherwise, which may move one of the scenes that the futures stand for.
        let near = |one: &[f64], other: &[f64]| one.iter().zip(other).all(|(one, other)| (one - other).abs() < 0.005);
        assert!(made.weights.len() == 20 && near(&made.weights, &stored.weights), "{name}: {:?}", made.weights);
        assert!(made.ends.len() == 10 && made.risks.len() == 2);
        assert!(near(made.risks.as_flattened(), stored.risks.as_flattened()), "{name}: {:?}", made.risks);
        let is_near = |(one, other): (&Position, &Position)| distance(*one, *other) < 0.01;
        assert!(made.ends.iter().zip(&stored.ends).all(is_near), "{name}: {:?}", made.ends);
    }
}
