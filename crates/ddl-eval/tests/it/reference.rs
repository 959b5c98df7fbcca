//! All metrics of windows of 1 to 5 pedestrians among others, as `tests/reference/scores.py` computes them.

use ddl_core::{Forecast, Pace, PedestrianId, Position, RegionTable, Spread, Window};
use ddl_data::{Convention, WindowRule};
use ddl_eval::significance::block_errors;
use ddl_eval::{CategoryScores, Conditions, Protocol, RecordingErrors, ResultRow, Scores, baseline};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

#[derive(Deserialize)]
struct OtherScores {
    regions: RegionTable,
    scores: Map<String, Value>,
    bare: Map<String, Value>,
    blocks: [Value; 2],
    baselines: Value,
    scenes: Vec<OtherScene>,
}

#[derive(Deserialize)]
struct OtherScene {
    recording: String,
    start: i64,
    step: i64,
    ids: Vec<i64>,
    scored: Vec<bool>,
    tracks: Vec<Vec<Position>>,
    paths: Vec<Position>,
    weights: Vec<f64>,
    goals: Vec<Position>,
    certified: Vec<bool>,
    scales: Vec<f64>,
    paces: Vec<usize>,
    familiarity: Vec<f64>,
}

/// Asserts that all numbers agree; fields that are not expected are not compared.
fn check(what: &str, actual: &Value, expected: &Value) {
    match (actual, expected) {
        (Value::Object(actual), Value::Object(expected)) => {
            for (name, expected) in expected {
                check(&format!("{what} {name}"), &actual[name], expected);
            }
        }
        (Value::Array(actual), Value::Array(expected)) => {
            assert_eq!(actual.len(), expected.len(), "{what}");
            actual.iter().zip(expected).for_each(|(a, e)| check(what, a, e));
        }
        (Value::Number(actual), Value::Number(expected)) => {
            let [actual, expected] = [actual, expected].map(|number| number.as_f64().unwrap());
            assert!((actual - expected).abs() < 1e-9, "{what}: {actual}, expected {expected}");
        }
        _ => assert_eq!(actual, expected, "{what}"),
    }
}

fn json(value: impl Serialize) -> Value {
    serde_json::to_value(value).unwrap()
}

#[test]
fn every_score_of_several_windows_is_the_one_computed_elsewhere() {
    let mut reference: OtherScores = serde_json::from_str(include_str!("../reference/scores.json")).unwrap();
    let (mut full_windows, mut windows, mut bare, mut forecasts) = (vec![], vec![], vec![], vec![]);
    for scene in reference.scenes {
        let ids = scene.ids.into_iter().map(PedestrianId).collect();
        let full = Window::new(scene.recording, scene.start, scene.step, ids, scene.tracks).unwrap();
        let window = full.filter_pedestrians(|i| scene.scored[i]).unwrap();
        let hypotheses = scene.weights.len() / window.len();
        let forecast = Forecast::new(window.len(), hypotheses, scene.paths, scene.weights, Some(scene.goals));
        let forecast = forecast.unwrap().with_certified(scene.certified).unwrap();
        let spread = Spread {
            scales: scene.scales,
            paces: scene.paces.into_iter().map(|pace| Pace::ALL[pace]).collect(),
            regions: reference.regions.clone().into(),
        };
        bare.push(forecast.clone());
        forecasts.push(forecast.with_familiarity(scene.familiarity).unwrap().with_spread(spread).unwrap());
        full_windows.push(full);
        windows.push(window);
    }
    let scores = |forecasts| json(Scores::under(Protocol::Joint, &windows, &full_windows, forecasts).unwrap());
    check("scores", &scores(&forecasts), &json(&reference.scores));
    reference.scores.extend(reference.bare);
    check("without spread", &scores(&bare), &json(&reference.scores));
    for (protocol, expected) in [Protocol::Fair, Protocol::Joint].into_iter().zip(&reference.blocks) {
        check("blocks", &json(block_errors(protocol, &windows, &forecasts).unwrap()), expected);
        let (convention, rule) = (Convention::Star, WindowRule::Complete);
        let conditions = Conditions::new(convention, rule, protocol, "yard", "any");
        let row = ResultRow::score(conditions, &windows, &forecasts).unwrap();
        check("row", &json(&row.blocks), expected);
        assert_eq!(row.scores.joint.is_some(), protocol == Protocol::Joint);
        // The means of the kinds of motion and of the recordings are those of the row.
        let recordings = row.by_recording();
        for (error, mean) in row.scores.errors(protocol).into_iter().enumerate() {
            let sum = |r: &RecordingErrors| [r.min_ade, r.min_fde][error] * r.pedestrians as f64;
            let of_kinds = row.scores.categories.iter();
            let of_kind = |c: &CategoryScores| c.errors(protocol).unwrap()[error] * c.pedestrians as f64;
            let sum_of_kinds = of_kinds.map(of_kind).sum::<f64>();
            assert!((sum_of_kinds - mean * row.scores.pedestrians as f64).abs() < 1e-9);
            let off = recordings.iter().map(sum).sum::<f64>() - mean * row.scores.pedestrians as f64;
            assert!(recordings.len() == 2 && off.abs() < 1e-9, "{recordings:?}");
        }
    }
    let (convention, rule, protocol) = (Convention::Star, WindowRule::Complete, Protocol::Published);
    let conditions = Conditions::new(convention, rule, protocol, "yard", "any");
    let rows = baseline::measure(&conditions, &windows).unwrap();
    let errors = [0, 1, 3, 5].map(|row| rows[row].scores.errors(protocol));
    check("baselines", &json(errors), &reference.baselines);
}
