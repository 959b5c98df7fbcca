//! `ddl pack`: a packed model forecasts as its run does without the expert library.

use ddl::data::{Convention, WindowRule};
use ddl::eval::{Conditions, ResultRow};
use ddl::report::Report;
use ddl::{Ddl, DdlError, DeviceChoice, Forecaster as _, ModelSource, Protocol, Variant};
use ddl_tests::{bits, crowd, folder_contents, own_tracks, program, tiny_model};
use proptest::prelude::*;
use proptest::test_runner::TestRunner;
use serde_json::json;
use std::path::Path;

const PACKED: &str = "DDL without an expert library";
/// Metres by which results may differ through weights in half precision.
const ROUNDING: f64 = 0.002;

/// The one row of that name under `fair`.
fn row<'a>(report: &'a Report, forecaster: &str) -> &'a ResultRow {
    let mut rows = report.rows().iter().filter(|row| {
        row.conditions.forecaster == forecaster && row.conditions.protocol == Protocol::Fair
    });
    let (Some(row), None) = (rows.next(), rows.next()) else {
        panic!("not one row {forecaster}");
    };
    row
}

#[test]
fn a_packed_run_is_measured_as_the_run_without_its_library() {
    let folder = tiny_model::folder(Variant::Full);
    let here = folder.path();
    let run = |command: &str| program::run(here, command).succeeds();
    let said = run("pack --model . --out packed.safetensors");
    assert!(said.contains("packed.safetensors"), "{said}");

    let measure = "--protocol fair --protocol single --test-walkers 120 --threads 1";
    let _ = run(&format!("evaluate --model . {measure}"));
    let before = folder_contents::read(here);
    let printed = run(&format!("evaluate --model packed.safetensors {measure}"));
    assert!(printed.contains(PACKED), "{printed}");
    // A packed model has no place for results of its own.
    assert_eq!(
        folder_contents::differences(&before, &folder_contents::read(here)),
        Vec::<String>::new()
    );
    let _ = run(&format!(
        "evaluate --model packed.safetensors --out packed {measure}"
    ));

    let of_run = Report::load(&here.join("report.json")).unwrap();
    let of_packed = Report::load(&here.join("packed/report.json")).unwrap();
    assert!(here.join("packed/report.html").is_file());
    let (expected, found) = (row(&of_run, PACKED), row(&of_packed, PACKED));
    assert_eq!(found.scores.pedestrians, expected.scores.pedestrians);
    assert!((found.scores.min_ade - expected.scores.min_ade).abs() < ROUNDING);
    assert!((found.scores.min_fde - expected.scores.min_fde).abs() < ROUNDING);
    // The library is what the rows of the run differ in: without that there would be nothing to compare.
    let whole = row(&of_run, "DDL");
    assert!((whole.scores.min_fde - expected.scores.min_fde).abs() > 1e-6);
    for row in [found, expected] {
        let recipe = row.conditions.recipe.as_deref().unwrap();
        assert!(recipe.contains("no expert library"), "{recipe}");
        assert_eq!(row.scores.stability.unwrap().certified, Some(1.0));
    }
    let recipe = whole.conditions.recipe.as_deref().unwrap();
    assert!(recipe.contains("and retrieved"), "{recipe}");
    let recipe = found.conditions.recipe.as_deref().unwrap();
    assert!(recipe.contains("16 bits"), "{recipe}");
    let lines = row(&of_packed, "straight line to the estimated goals");
    let lines = lines.conditions.recipe.as_deref().unwrap();
    assert!(lines.contains("no expert library"), "{lines}");
    // It has learned stable walks, and plain steps lead where it has never been.
    let rows = of_run.rows().iter().chain(of_packed.rows());
    let mut names = rows.map(|row| &row.conditions.forecaster);
    assert!(names.all(|name| !name.contains("plain Euler")));
}

#[test]
fn every_command_takes_a_packed_model() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let model = tiny_model::of(Variant::Full).model;
    model.pack(&here.join("packed")).unwrap();
    let tracks = own_tracks::csv(&own_tracks::three_people(8));
    std::fs::write(here.join("tracks.csv"), tracks).unwrap();
    let run = |command: &str| program::run(here, command).succeeds();
    let forecasts = run("forecast --model packed tracks.csv --whole");
    assert_eq!(forecasts.lines().count(), 1 + 3 * 20 * 12);
    let goals = run("goals --model packed tracks.csv --whole");
    assert_eq!(goals.lines().count(), 1 + 3 * 20);
    let measured = run("goals --model packed --measure test --svg goals.svg --threads 1");
    assert!(measured.contains("no expert library"), "{measured}");
    assert!(here.join("goals.svg").is_file());
    let info: serde_json::Value = serde_json::from_str(&run("info --model packed --json")).unwrap();
    assert_eq!(
        (&info["experts"], &info["config"]["data"]["fold"]),
        (&0.into(), &crowd::FOLD.into())
    );
    assert_eq!(info["parameters"], model.parameter_count());
    assert!(model.parameter_count() > 10_000);
    let _ = run("pack --model packed --out again");
    let read = |name: &str| std::fs::read(here.join(name)).unwrap();
    assert!(
        read("packed") == read("again"),
        "packing a packed model changes it"
    );
}

#[test]
fn what_a_packed_model_cannot_do_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    tiny_model::of(Variant::Full)
        .model
        .pack(&here.join("packed"))
        .unwrap();
    let fails = |command: &str| program::run(here, command).fails();
    let published = fails("evaluate --model packed --protocol published");
    assert!(published.contains("no expert library"), "{published}");
    let other_data = fails("evaluate --model zara1 --convention simulated");
    assert!(
        other_data.contains("cannot be measured on `simulated`"),
        "{other_data}"
    );
    // A model is measured on no scene but the one left out.
    for other_fold in [
        "evaluate --model packed --fold plaza",
        "evaluate --model zara1 --fold eth",
    ] {
        assert_eq!(program::run(here, other_fold).code, Some(2), "{other_fold}");
    }
    let retrieved = tempfile::tempdir().unwrap();
    let mut request = tiny_model::request(crowd::FOLD, Variant::Full, 40, retrieved.path());
    request.goals = ddl::GoalRecipe::retrieved(1);
    tiny_model::train(&request, &crowd::dataset());
    let run = retrieved.path().display();
    let message = fails(&format!("pack --model {run} --out new"));
    assert!(message.contains("--goals proposed"), "{message}");
    assert!(!here.join("new").exists());
}

/// A finished benchmark of these folds: the tiny model as the run of each, and what it is said to have reached.
fn benchmark(profile: &str, convention: &str, folds: &[&str]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let run = folder_contents::read(tiny_model::folder(Variant::Full).path());
    let measured = ddl::measure_baselines(
        &crowd::dataset(),
        &[crowd::FOLD.to_owned()],
        &[Protocol::Fair],
        Some(8),
        "0123abc",
    );
    let measured = measured.unwrap().remove(0);
    let mut tasks = Vec::new();
    for (fold, seed) in folds.iter().flat_map(|fold| [(fold, 2), (fold, 1)]) {
        let id = format!("{fold}-full-{seed}");
        let row = |forecaster: &str| {
            let mut row = measured.clone();
            row.conditions = Conditions {
                seed: Some(seed),
                commit: "0123abc".to_owned(),
                ..Conditions::new(
                    Convention::Star,
                    WindowRule::Published,
                    Protocol::Fair,
                    *fold,
                    forecaster,
                )
            };
            row.scores.min_ade = if forecaster == PACKED {
                seed as f64
            } else {
                9.0
            };
            row
        };
        let report = Report::new(&id, [row("DDL"), row(PACKED)]).unwrap();
        let at = folder.path().join(&id).join("run");
        folder_contents::write(&run, &at);
        std::fs::write(at.join("report.json"), report.to_json().unwrap()).unwrap();
        tasks.push(json!({
            "id": id, "fold": fold, "variant": "full", "seed": seed, "train_cost": 1.0, "evaluate_cost": 1.0,
        }));
    }
    let plan = json!({
        "format": 3,
        "settings": {
            "profile": profile, "convention": convention, "data": null, "device": "cpu", "cargo_profile": "release", "epochs": 4,
            "train_walkers": null, "proposal_steps": null, "test_walkers": 2500, "protocols": ["fair", "single"],
            "recipe": {"name": "recommended", "optimiser": null},
        },
        "tasks": tasks,
    });
    std::fs::write(folder.path().join("plan.json"), plan.to_string()).unwrap();
    folder
}

const FOLDS: [&str; 5] = ["eth", "hotel", "univ", "zara1", "zara2"];

#[test]
fn a_benchmark_becomes_the_models_that_come_with_the_program() {
    let folder = benchmark("paper", "star", &FOLDS);
    let here = folder.path();
    for (option, seed) in [("", 1), (" --seed 2", 2)] {
        let said =
            program::run(here, &format!("pack --benchmark . --out models{option}")).succeeds();
        assert_eq!(said.matches(" weights\n").count(), 5, "{said}");
        let text = std::fs::read(here.join("models/reported.json")).unwrap();
        let reported: serde_json::Value = serde_json::from_slice(&text).unwrap();
        assert_eq!(reported.as_object().unwrap().len(), 5);
        for fold in FOLDS {
            let packed = here.join("models").join(format!("{fold}.safetensors"));
            assert!(Ddl::load(&packed, DeviceChoice::Cpu).is_ok());
            let one = &reported[fold];
            assert_eq!(
                (&one["min_ade"], &one["seed"]),
                (&json!(seed as f64), &json!(seed))
            );
            assert_eq!(
                (&one["window_rule"], &one["protocol"]),
                (&json!("published"), &json!("fair"))
            );
            assert_eq!(
                (&one["test_walkers"], &one["commit"]),
                (&json!(2500), &json!("0123abc"))
            );
            assert!(one["walkers"].as_u64().unwrap() > 0 && one["min_fde"].is_f64());
        }
    }
}

#[test]
fn half_a_benchmark_is_refused_and_nothing_replaced() {
    let error = |folder: &Path| {
        let said = program::run(folder, "pack --benchmark . --out models").fails();
        assert!(!folder.join("models").exists());
        said
    };
    for (profile, convention, folds, pieces) in [
        ("paper", "star", &FOLDS[..4], ["zara2", "all folds"]),
        ("paper", "social-gan", &FOLDS[..1], ["social-gan", "star"]),
        ("quick", "star", &FOLDS[..1], ["of profile quick", "paper"]),
    ] {
        let said = error(benchmark(profile, convention, folds).path());
        assert!(pieces.iter().all(|piece| said.contains(piece)), "{said}");
    }
    let folder = benchmark("paper", "star", &FOLDS);
    let run = folder.path().join("univ-full-1/run");
    // Every other fold can be packed.
    std::fs::write(run.join("model.safetensors"), "damaged").unwrap();
    let damaged = error(folder.path());
    assert!(damaged.contains("univ-full-1"), "{damaged}");
    std::fs::write(
        run.join("report.json"),
        Report::new("older", []).unwrap().to_json().unwrap(),
    )
    .unwrap();
    let older = error(folder.path());
    assert!(
        older.contains("univ-full-1") && older.contains(PACKED),
        "{older}"
    );
    std::fs::remove_file(run.join("report.json")).unwrap();
    let unfinished = error(folder.path());
    assert!(
        unfinished.contains("is the benchmark finished?"),
        "{unfinished}"
    );
    std::fs::remove_file(folder.path().join("plan.json")).unwrap();
    assert!(error(folder.path()).contains("`ddl benchmark` makes"));
}

#[test]
fn the_network_comes_back_in_every_variant() {
    let windows = crowd::windows(3, 6);
    for variant in [Variant::NoGoalShift, Variant::NoDynamics, Variant::Star] {
        let tiny = tiny_model::of(variant);
        let file = tiny.folder().join("packed");
        tiny.model.pack(&file).unwrap();
        let packed = Ddl::load(&file, DeviceChoice::Cpu).unwrap();
        assert_eq!(packed.config(), tiny.model.config());
        assert_eq!(packed.source(), &ModelSource::Packed(file));
        let forecasts = packed.forecast_all(&windows).unwrap();
        if variant == Variant::Star {
            // It reads no goals: only the rounding of its weights is left.
            let of_run = tiny.model.forecast_all(&windows).unwrap();
            for (one, other) in of_run.iter().zip(&forecasts) {
                for (i, k) in (0..one.pedestrians()).flat_map(|i| (0..20).map(move |k| (i, k))) {
                    let pairs = one.hypothesis(i, k).iter().zip(other.hypothesis(i, k));
                    for ([x, y], [u, v]) in pairs {
                        assert!((x - u).hypot(y - v) < 0.02, "({x}, {y}), ({u}, {v})");
                    }
                }
            }
        }
    }
}

/// Loads what a file of these bytes holds, and says what it forecasts.
fn forecast_bits(file: &Path) -> Result<Vec<Vec<u64>>, DdlError> {
    let model = Ddl::load(file, DeviceChoice::Cpu)?;
    Ok(bits::of_all(&model.forecast_all(&crowd::windows(1, 3))?))
}

/// What may happen to a file on its way: it ends early, or bits of it turn.
fn damaged(whole: &[u8], length: Option<usize>, flips: &[(usize, u8)]) -> Vec<u8> {
    let mut bytes = whole[..length.unwrap_or(whole.len())].to_vec();
    for &(place, bit) in flips {
        if let Some(byte) = bytes.get_mut(place) {
            *byte ^= 1 << bit;
        }
    }
    bytes
}

/// Wherever a file is damaged it is refused, with its name, or the damage made no difference (blanks at the end of its header).
#[test]
fn no_damage_goes_unnoticed() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("packed");
    tiny_model::of(Variant::Full).model.pack(&file).unwrap();
    let whole = std::fs::read(&file).unwrap();
    let expected = forecast_bits(&file).unwrap();
    let refused = |bytes: &[u8]| {
        std::fs::write(&file, bytes).unwrap();
        match forecast_bits(&file) {
            Err(error) => assert!(error.to_string().contains("packed"), "{error}"),
            Ok(found) => assert_eq!(found, expected),
        }
    };
    let header = 8 + u64::from_le_bytes(whole[..8].try_into().unwrap()) as usize;
    let last = whole.len() - 1;
    for length in [0, 1, 7, 8, 9, header - 1, header, header + 1, last] {
        refused(&whole[..length]);
    }
    refused(&[&whole[..], &[0]].concat());
    // Every bit of the header's length and of its beginning.
    for (place, bit) in (0..16).flat_map(|place| (0..8).map(move |bit| (place, bit))) {
        refused(&damaged(&whole, None, &[(place, bit)]));
    }
    let place = prop_oneof![0..header, 0..last];
    let flips = proptest::collection::vec((place, 0..8_u8), 1..4);
    let lengths = proptest::option::weighted(0.2, prop_oneof![0..header, 0..last]);
    let mut runner = TestRunner::new(ProptestConfig {
        failure_persistence: None,
        ..ProptestConfig::with_cases(256)
    });
    runner
        .run(&(flips, lengths), |(flips, length)| {
            refused(&damaged(&whole, length, &flips));
            Ok(())
        })
        .unwrap();
    // Weights alone are no model, and say so.
    let tiny = tiny_model::folder(Variant::Full);
    let error = forecast_bits(&tiny.path().join("model.safetensors")).unwrap_err();
    assert!(error.to_string().contains("ddl pack"), "{error}");
}
