//! A finished benchmark: its report (`ddl benchmark --collect`), and its models as built-in ones (`ddl pack
//! --benchmark`).

use ddl::data::Convention;
use ddl::eval::{Conditions, baseline};
use ddl::report::Report;
use ddl::{Ddl, DeviceChoice, EvaluationRequest, Protocol, Variant};
use ddl_tests::place::{Place, json};
use ddl_tests::{crowd, drawn_model, folder_contents};
use serde_json::{Value, json};

const PACKED: &str = "DDL as packed";
const FOLDS: [&str; 5] = ["eth", "hotel", "univ", "zara1", "zara2"];
const PACK: &str = "pack --benchmark . --out models";

/// A finished benchmark of these folds, with a drawn model as each run, and invented results.
fn benchmark(profile: &str, convention: Convention, folds: &[&str]) -> Place {
    let place = Place::empty();
    let conditions = Conditions::new(convention, convention.headline_rule(), Protocol::Fair, crowd::FOLD, "");
    let measured = baseline::measure(&conditions, &crowd::windows(4, 20)).unwrap().remove(0);
    let mut tasks = Vec::new();
    for (&fold, seed) in folds.iter().flat_map(|fold| [(fold, 2), (fold, 1)]) {
        let row = |forecaster: &str, min_ade| {
            let rule = convention.headline_rule();
            let mut row = measured.clone();
            row.conditions = Conditions {
                seed: Some(seed),
                commit: "0123abc".to_owned(),
                ..Conditions::new(convention, rule, Protocol::Fair, fold, forecaster)
            };
            row.scores.min_ade = min_ade;
            row
        };
        let id = format!("{fold}-full-{seed}");
        let rows = [row("DDL", 9.0), row(PACKED, seed as f64)];
        let run = place.at(&id).join("run");
        folder_contents::write(drawn_model::contents(Variant::Full), &run);
        let report = Report::new(&id, rows).unwrap().to_json().unwrap();
        place.write(&format!("{id}/run/report.json"), report);
        tasks.push(json!({
            "id": id, "fold": fold, "variant": "full", "seed": seed, "train_cost": 1.0, "evaluate_cost": 1.0,
        }));
    }
    let plan = json!({
        "format": 3,
        "settings": {
            "profile": profile, "convention": convention.to_string(), "data": null, "device": "cpu",
            "cargo_profile": "release",
            "epochs": 20, "train_pedestrians": null, "proposal_steps": null, "test_pedestrians": 2500,
            "protocols": ["fair", "single"],
            "recipe": {"name": "recommended", "optimiser": null},
        },
        "tasks": tasks,
    });
    place.write("plan.json", plan.to_string());
    place
}

#[test]
fn a_benchmark_is_packed_as_built_in_models() {
    let place = benchmark("paper", Convention::Star, &FOLDS);
    for (option, seed) in [("", 1), (" --seed 2", 2)] {
        let said = place.ok(&format!("{PACK}{option}"));
        assert_eq!(said.matches(" weights\n").count(), 5, "{said}");
        let reported: Value = json(&place.text("models/reported.json"));
        assert_eq!(reported.as_object().unwrap().len(), 5);
        for fold in FOLDS {
            let packed = place.at(&format!("models/{fold}.safetensors"));
            assert!(Ddl::load(&packed, DeviceChoice::Cpu).is_ok());
            let one = &reported[fold];
            for (fact, expected) in [
                ("min_ade", json!(f64::from(seed))),
                ("seed", json!(seed)),
                ("window_rule", json!("published")),
                ("protocol", json!("fair")),
                ("test_pedestrians", json!(2500)),
                ("commit", json!("0123abc")),
            ] {
                assert_eq!(one[fact], expected, "{fact}");
            }
            assert!(one["pedestrians"].as_u64().unwrap() > 0 && one["min_fde"].is_f64());
        }
    }
}

#[test]
fn the_main_tables_hold_the_numbers_of_the_report() {
    const COLLECT: &str = "benchmark --out . --collect";
    let place = benchmark("smoke", Convention::Simulated, &[crowd::FOLD]);
    let ids = [1, 2].map(|seed| format!("{}-full-{seed}", crowd::FOLD));
    for id in &ids {
        let finished = json!({"task": id, "seconds": 1.0});
        place.write(&format!("{id}/finished.json"), finished.to_string());
    }
    let said = place.run(COLLECT).stderr;
    let report: Value = json(&place.text("report.json"));
    let rows = report["rows"].as_array().unwrap().iter();
    let errors: Vec<f64> = rows
        .filter(|row| row["conditions"]["forecaster"] == "DDL")
        .map(|row| row["scores"]["min_fde"].as_f64().unwrap())
        .collect();
    assert_eq!(errors.len(), ids.len(), "{report}");
    let expected = format!("9.000/{:.3}", errors.iter().sum::<f64>() / errors.len() as f64);
    let summary = place.text("summary.md");
    assert!(summary.contains(&expected), "{expected}: {summary}");
    assert!(said.contains("main tables"), "{said}");

    // The protocol `published` has no main tables, and those of the report before are out of date.
    for id in &ids {
        let file = format!("{id}/run/report.json");
        let (fair, published) = (r#""protocol":"fair""#, r#""protocol":"published""#);
        let text = place.text(&file);
        assert!(text.contains(fair), "{text}");
        place.write(&file, text.replace(fair, published));
    }
    let said = place.run(COLLECT).stderr;
    assert!(said.contains("report.md") && !said.contains("summary.md"), "{said}");
    assert!(!place.at("summary.md").exists());
}

#[test]
fn results_on_different_recordings_of_one_name_are_not_joined() {
    let place = benchmark("paper", Convention::Star, &FOLDS[..2]);
    let runs = ["eth-full-1/run", "hotel-full-1/run"];
    let report = format!("report {} --out joined", runs.join(" "));
    for (sha256, is_same) in [("ab", true), ("cd", false)] {
        for (run, sha256) in runs.into_iter().zip(["ab", sha256]) {
            let recording = json!({"name": "students", "frame_step": 10, "sha256": sha256});
            let record = json!({
                "request": EvaluationRequest::new(vec![Protocol::Fair]), "recordings": [recording], "device": "cpu",
            });
            place.write(&format!("{run}/evaluation.json"), record.to_string());
        }
        if is_same {
            place.ok(&report);
        } else {
            place.fails(&report, &[runs[0], runs[1], "students"]);
        }
    }
}

#[test]
fn an_unfinished_benchmark_is_refused_and_nothing_replaced() {
    for (profile, convention, folds, words) in [
        ("paper", Convention::Star, &FOLDS[..4], ["zara2", "all folds"]),
        ("paper", Convention::SocialGan, &FOLDS[..1], ["social-gan", "star"]),
        ("quick", Convention::Star, &FOLDS[..1], ["of profile quick", "paper"]),
    ] {
        benchmark(profile, convention, folds).fails(PACK, &words);
    }
    let place = benchmark("paper", Convention::Star, &FOLDS);
    // The other folds could be packed.
    place.write("univ-full-1/run/model.safetensors", "damaged");
    place.fails(PACK, &["univ-full-1"]);
    let older = Report::new("older", []).unwrap().to_json().unwrap();
    place.write("univ-full-1/run/report.json", older);
    place.fails(PACK, &["univ-full-1", PACKED]);
    place.remove("univ-full-1/run/report.json");
    place.fails(PACK, &["finish the benchmark first"]);
    place.remove("plan.json");
    place.fails(PACK, &["`ddl benchmark` made"]);
}
