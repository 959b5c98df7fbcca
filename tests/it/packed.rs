//! `ddl pack`: a packed model forecasts like its run without the expert library; and the built-in packed models.

use ddl::eval::ResultRow;
use ddl::report::Report;
use ddl::{BuiltinModel, ModelSource};
use ddl_tests::place::{Place, json};
use ddl_tests::{folder_contents, recordings};
use serde_json::Value;
use std::collections::BTreeMap;

use crate::other_program::row;

const AS_PACKED: &str = "DDL as packed";
/// Allowed difference (m) of results due to weights in half precision, or another machine.
const ROUNDING: f64 = 0.002;

fn recipe(row: &ResultRow) -> &str {
    row.conditions.recipe.as_deref().unwrap()
}

#[test]
fn a_packed_run_has_the_results_of_the_run_without_its_library() {
    let place = Place::with_model();
    let said = place.ok("pack --model run --out packed.safetensors");
    assert!(said.contains("packed.safetensors"), "{said}");
    let measure = "--protocol fair,single --test-pedestrians 120 --threads 1";
    let _ = place.ok(&format!("evaluate --model run {measure}"));
    let before = folder_contents::read(place.path());
    let line = format!("evaluate --model packed.safetensors {measure}");
    let printed = place.ok(&line);
    assert!(printed.contains("DDL ") && !printed.contains(AS_PACKED), "{printed}");
    // A packed model cannot store results itself.
    place.assert_unchanged_since(&before);
    let _ = place.ok(&format!("{line} --out packed"));

    let of_run = Report::load(&place.at("run/report.json")).unwrap();
    let of_packed = Report::load(&place.at("packed/report.json")).unwrap();
    assert!(place.at("packed/report.html").is_file());
    let (expected, measured) = (row(&of_run, "fair", AS_PACKED), row(&of_packed, "fair", "DDL"));
    assert_eq!(measured.scores.pedestrians, expected.scores.pedestrians);
    assert!((measured.scores.min_ade - expected.scores.min_ade).abs() < ROUNDING);
    assert!((measured.scores.min_fde - expected.scores.min_fde).abs() < ROUNDING);
    // The rows of the run differ only in the library. They must differ, otherwise the comparison would prove nothing.
    let whole = row(&of_run, "fair", "DDL");
    assert!((whole.scores.min_fde - expected.scores.min_fde).abs() > 1e-6);
    let lines = row(&of_packed, "fair", "straight line to the estimated goals");
    for (row, words) in [
        (measured, "no expert library"),
        (measured, "16 bits"),
        (expected, "no expert library"),
        (lines, "no expert library"),
        (whole, "and retrieved"),
    ] {
        assert!(recipe(row).contains(words), "{}", recipe(row));
    }
    for row in [measured, expected] {
        assert_eq!(row.scores.stability.unwrap().certified, Some(1.0));
    }
    // Networks of this recipe learn stable rollouts, and plain Euler steps leave the learned region.
    let mut names = of_run.rows().iter().chain(of_packed.rows()).map(|row| &row.conditions.forecaster);
    assert!(names.all(|name| !name.contains("plain Euler")));
}

#[test]
fn every_command_accepts_a_packed_model() {
    let place = Place::with_model();
    let _ = place.ok("pack --model run --out packed");
    let forecasts = place.ok("forecast --model packed tracks.csv --whole --last");
    assert_eq!(forecasts.lines().count(), 1 + 3 * 20 * 12);
    let measured = place.ok("goals --model packed --measure test --threads 1");
    assert!(measured.contains("no expert library"), "{measured}");
    let [info, of_run] = ["packed", "run"].map(|model| place.json(&format!("info {model} --json")));
    assert_eq!(info["experts"], 0);
    for fact in ["config", "parameters"] {
        assert_eq!(info[fact], of_run[fact], "{fact}");
    }
    let _ = place.ok("pack --model packed --out again");
    assert!(place.read("packed") == place.read("again"), "packing a packed model changes it");
}

fn reported() -> BTreeMap<String, Value> {
    json(include_str!("../../crates/ddl/models/reported.json"))
}

#[test]
fn every_built_in_model_has_a_reported_result_of_its_seed() {
    let reported = reported();
    let names: Vec<&str> = reported.keys().map(String::as_str).collect();
    assert_eq!(names, BuiltinModel::OF_FOLDS.map(BuiltinModel::name));
    for model in BuiltinModel::OF_FOLDS {
        let (one, config) = (&reported[model.name()], ModelSource::Builtin(model).config().unwrap());
        assert_eq!(one["convention"], config.data.convention.name());
        assert_eq!(one["seed"], config.training.seed);
        let [ade, fde] = ["min_ade", "min_fde"].map(|error| one[error].as_f64().unwrap());
        assert!(ade > 0.0 && ade < fde && one["commit"].as_str().is_some_and(|commit| !commit.is_empty()));
    }
}

#[test]
fn the_reported_number_is_reproduced() {
    let Some(data) = recordings::star_folder() else {
        return;
    };
    let expected = &reported()["hotel"];
    let place = Place::empty();
    let _ = place.ok(&format!(
        "evaluate --fold hotel --protocol {} --out results --data {}",
        expected["protocol"].as_str().unwrap(),
        data.display()
    ));
    let report = Report::load(&place.at("results/report.json")).unwrap();
    let mut rows = report.rows().iter().filter(|row| row.conditions.forecaster == "DDL");
    let row = rows.find(|row| expected["window_rule"] == row.conditions.window_rule.to_string());
    let scores = &row.unwrap().scores;
    assert_eq!(expected["pedestrians"], scores.pedestrians);
    for (measured, error) in [(scores.min_ade, "min_ade"), (scores.min_fde, "min_fde")] {
        let expected = expected[error].as_f64().unwrap();
        let off = (measured - expected).abs();
        assert!(off < ROUNDING, "{measured}, reported {expected}");
    }
}
