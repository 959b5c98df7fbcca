//! `ddl goals` and `ddl info`.

use ddl::Variant;
use ddl_tests::{own_tracks, program, tiny_model};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::Path;

#[derive(Deserialize)]
struct Goal {
    observed_until: i64,
    pedestrian: i64,
    weight: f64,
    x: f64,
    y: f64,
}

#[test]
fn goals_of_own_tracks_are_those_of_the_forecasts() {
    let folder = tiny_model::folder(Variant::Full);
    let rows = own_tracks::three_people(9);
    std::fs::write(folder.path().join("tracks.csv"), own_tracks::csv(&rows)).unwrap();
    let ask = |command: &str| {
        program::run(
            folder.path(),
            &format!("{command} --model . tracks.csv --whole"),
        )
        .succeeds()
    };
    let goals: Vec<Goal> = csv::Reader::from_reader(ask("goals").as_bytes())
        .deserialize()
        .collect::<Result<_, _>>()
        .unwrap();
    let mut weights: BTreeMap<(i64, i64), Vec<f64>> = BTreeMap::new();
    for goal in &goals {
        let walker = (goal.observed_until, goal.pedestrian);
        weights.entry(walker).or_default().push(goal.weight);
    }
    // two moments, three people
    assert_eq!(weights.len(), 6);
    for (walker, weights) in &weights {
        assert_eq!(weights.len(), 20, "{walker:?}");
        assert!((weights.iter().sum::<f64>() - 1.0).abs() < 1e-9);
    }

    let forecasts = ask("forecast --format jsonl");
    let mut goals = goals.into_iter();
    for line in forecasts.lines() {
        let forecast: serde_json::Value = serde_json::from_str(line).unwrap();
        for hypothesis in forecast["hypotheses"].as_array().unwrap() {
            let goal = goals.next().unwrap();
            assert_eq!(forecast["pedestrian"], goal.pedestrian);
            let found = [0, 1].map(|axis| hypothesis["goal"][axis].as_f64().unwrap());
            assert!(own_tracks::alike_in_a_table([goal.x, goal.y], found));
            assert_eq!(hypothesis["weight"], goal.weight);
        }
    }
    assert!(goals.next().is_none());
}

/// How many numbers a safetensors file says it holds.
fn numbers_in(file: &Path) -> u64 {
    let bytes = std::fs::read(file).unwrap();
    let (length, rest) = bytes.split_first_chunk::<8>().unwrap();
    let length = usize::try_from(u64::from_le_bytes(*length)).unwrap();
    let header: serde_json::Value = serde_json::from_slice(&rest[..length]).unwrap();
    let tensors = header.as_object().unwrap().iter();
    tensors
        .filter(|(name, _)| *name != "__metadata__")
        .map(|(_, tensor)| {
            let shape = tensor["shape"].as_array().unwrap();
            let sizes = shape.iter().map(|size| size.as_u64().unwrap());
            sizes.product::<u64>()
        })
        .sum()
}

#[test]
fn info_describes_program_and_model() {
    let run = tiny_model::folder(Variant::NoGoalShift);
    let here = run.path();
    let info = |options: &str| program::run(here, &format!("info {options}")).succeeds();
    let of_program: serde_json::Value = serde_json::from_str(&info("--json")).unwrap();
    assert_eq!(of_program["version"], env!("CARGO_PKG_VERSION"));
    assert!(of_program["cuda"].is_string());

    let json = info("--model . --json");
    let of_model: serde_json::Value = serde_json::from_str(&json).unwrap();
    let config = std::fs::read_to_string(here.join("config.json")).unwrap();
    let config: serde_json::Value = serde_json::from_str(&config).unwrap();
    assert_eq!(of_model["config"], config);
    assert_eq!(config["star"]["variant"], "no-goal-shift");
    assert_eq!(of_model["epochs"].as_array().unwrap().len(), 1);
    assert_eq!(of_model["experts"], config["data"]["walkers"]);
    let parameters = of_model["parameters"].as_u64().unwrap();
    assert_eq!(parameters, numbers_in(&here.join("model.safetensors")));
    assert!(parameters > 10_000);

    let for_people = info("--model .");
    let walkers = &config["data"]["walkers"];
    let sentence = format!(
        ".: variant no-goal-shift, trained on {walkers} walks of 20 steps (convention simulated, without corridor); goals "
    );
    assert!(for_people.starts_with(&sentence), "{for_people}");
    std::fs::remove_file(here.join("model.safetensors")).unwrap();
    let unfinished = info("--model .");
    let sentence = sentence.replace("trained on", "to be trained on");
    assert!(unfinished.starts_with(&sentence), "{unfinished}");
    assert!(
        for_people.contains("variant: no-goal-shift"),
        "{for_people}"
    );
}
