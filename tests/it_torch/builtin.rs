//! The models that come with the program.

use ddl::data::Convention;
use ddl::report::Report;
use ddl::{BuiltinModel, Protocol};
use ddl_tests::program::{self, Finished};
use ddl_tests::{own_tracks, recordings};
use serde::Deserialize;
use std::collections::BTreeMap;

/// The smallest test scene.
const FOLD: &str = "hotel";
/// Metres by which a result may differ from the one reported: machines round differently, and the weights are rounded.
const TOLERANCE: f64 = 0.002;

/// What is reported of a model, beside its weights.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Reported {
    convention: Convention,
    window_rule: String,
    protocol: Protocol,
    min_ade: f64,
    min_fde: f64,
    walkers: usize,
    test_walkers: Option<usize>,
    seed: u64,
    commit: String,
}

fn reported() -> BTreeMap<String, Reported> {
    let text = include_str!("../../crates/ddl/models/reported.json");
    serde_json::from_str(text).unwrap()
}

#[test]
fn every_model_is_reported_and_of_the_seed_it_is_reported_with() {
    let reported = reported();
    let names: Vec<&str> = reported.keys().map(String::as_str).collect();
    assert_eq!(names, BuiltinModel::ALL.map(BuiltinModel::name));
    for model in BuiltinModel::ALL {
        let (one, config) = (&reported[model.name()], model.config().unwrap());
        assert_eq!(one.convention, config.data.convention);
        assert_eq!(one.seed, config.training.seed);
        assert!(one.min_ade > 0.0 && one.min_ade < one.min_fde && !one.commit.is_empty());
    }
}

/// With the program alone: no run, no recordings, no option.
#[test]
fn own_tracks_are_forecast_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let tracks = own_tracks::csv(&own_tracks::three_people(8));
    std::fs::write(here.join("tracks.csv"), tracks).unwrap();
    let run = |command: &str| program::run(here, command).succeeds();
    let forecasts = run("forecast tracks.csv --whole");
    assert_eq!(forecasts.lines().count(), 1 + 3 * 20 * 12);
    let default = BuiltinModel::default();
    let by_name =
        |model: BuiltinModel| run(&format!("forecast --model {model} tracks.csv --whole"));
    assert_eq!(by_name(default), forecasts);
    let other = BuiltinModel::ALL
        .into_iter()
        .find(|model| *model != default);
    assert_ne!(by_name(other.unwrap()), forecasts);
    assert_eq!(run("goals tracks.csv --whole").lines().count(), 1 + 3 * 20);
    let info: serde_json::Value = serde_json::from_str(&run("info --json")).unwrap();
    assert_eq!(info["models"].as_array().unwrap().len(), 5);
    let of_model: serde_json::Value =
        serde_json::from_str(&run("info --model zara1 --json")).unwrap();
    assert_eq!(of_model["config"]["data"]["fold"], "zara1");

    let fails = |command: &str| program::run(here, command).fails();
    let elsewhere = fails("evaluate --fold plaza --convention simulated");
    assert!(elsewhere.contains("star"), "{elsewhere}");
    let unknown = fails("evaluate --fold corridor");
    assert!(
        unknown.contains("corridor") && unknown.contains("zara1"),
        "{unknown}"
    );
}

#[test]
fn the_reported_number_comes_out_again() {
    let Some(data) = recordings::star_folder() else {
        return;
    };
    let expected = &reported()[FOLD];
    let folder = tempfile::tempdir().unwrap();
    let walkers = expected
        .test_walkers
        .map_or(String::new(), |walkers| format!("--test-walkers {walkers}"));
    let command_line = format!(
        "evaluate --fold {FOLD} --protocol {} {walkers} --out results",
        expected.protocol
    );
    let mut command = program::command(folder.path(), &command_line);
    let output = command.arg("--data").arg(&data).output().unwrap();
    let _ = Finished::new(command_line, &output).succeeds();
    let report = Report::load(&folder.path().join("results/report.json")).unwrap();
    let row = report.rows().iter().find(|row| {
        let conditions = &row.conditions;
        conditions.forecaster == "DDL without an expert library"
            && conditions.window_rule.to_string() == expected.window_rule
            && conditions.protocol == expected.protocol
    });
    let scores = &row.unwrap().scores;
    assert_eq!(scores.pedestrians, expected.walkers);
    let (ade, fde) = (scores.min_ade, scores.min_fde);
    assert!(
        (ade - expected.min_ade).abs() < TOLERANCE,
        "{ade}: {expected:?}"
    );
    assert!(
        (fde - expected.min_fde).abs() < TOLERANCE,
        "{fde}: {expected:?}"
    );
}
