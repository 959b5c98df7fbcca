//! A finished benchmark by hand, and a program that packs by writing down what it was asked to pack.
#![cfg(unix)]

use super::*;
use crate::benchmark::{RECOMMENDED, Settings};
use serde_json::json;
use std::os::unix::fs::PermissionsExt as _;
use tempfile::TempDir;

const FOLDS: [&str; 5] = ["eth", "hotel", "univ", "zara1", "zara2"];

/// A folder with a benchmark, the program `ddl`, and a place for the models.
struct Made {
    folder: TempDir,
}

impl Made {
    fn new(convention: &str, folds: &[&str]) -> Self {
        Self::of_profile("paper", convention, folds)
    }

    fn of_profile(profile: &str, convention: &str, folds: &[&str]) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let settings = Settings {
            profile: profile.to_owned(),
            convention: convention.to_owned(),
            data: None,
            device: "cpu".to_owned(),
            cargo_profile: "release".to_owned(),
            epochs: 4,
            train_walkers: None,
            proposal_steps: None,
            test_walkers: Some(2500),
            protocols: vec!["fair".to_owned(), "single".to_owned()],
            recipe: RECOMMENDED,
        };
        let folds: Vec<String> = folds.iter().map(|&fold| fold.to_owned()).collect();
        let variants = ["full", "star"].map(str::to_owned);
        let plan = Plan::new(settings, &folds, &variants, &[2, 1]).unwrap();
        let from = folder.path().join("benchmark");
        plan.write(&from).unwrap();
        for (index, task) in plan.tasks.iter().enumerate() {
            let row = |forecaster: &str, protocol: &str, min_ade: f64| {
                json!({
                    "conditions": {
                        "convention": "star", "window_rule": "published", "protocol": protocol, "fold": task.fold,
                        "forecaster": forecaster, "seed": task.seed, "commit": "0123abc",
                    },
                    "scores": { "min_ade": min_ade, "min_fde": 2.0 * min_ade, "pedestrians": 1000 + index },
                })
            };
            let rows = [
                row("DDL", "fair", 9.0),
                row(FORECASTER, "single", 8.0),
                row(FORECASTER, "fair", 0.1 + task.seed as f64),
            ];
            let report = task.run_folder(&from).join("report.json");
            whole_file::write(&report, json!({ "rows": rows }).to_string().as_bytes()).unwrap();
        }
        let made = Self { folder };
        made.program("printf '%s' \"$1 $3\" > \"$5\"");
        made
    }

    fn program(&self, script: &str) {
        let path = self.path("ddl");
        fs::write(&path, format!("#!/bin/sh\n{script}\n")).unwrap();
        fs::set_permissions(&path, fs::Permissions::from_mode(0o755)).unwrap();
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn make(&self, seed: Option<u64>) -> Result<()> {
        let arguments = Arguments {
            from: self.path("benchmark"),
            seed,
            program: Some(self.path("ddl")),
            out: self.path("models"),
        };
        arguments.run(&Workspace::find().unwrap())
    }

    fn error(&self) -> String {
        format!("{:#}", self.make(None).unwrap_err())
    }
}

#[test]
fn every_fold_is_packed_and_its_result_stands_beside_it() {
    let made = Made::new("star", &FOLDS);
    for (seed, expected) in [(None, 1), (Some(2), 2)] {
        made.make(seed).unwrap();
        let text = fs::read(made.path("models/reported.json")).unwrap();
        let reported: Value = serde_json::from_slice(&text).unwrap();
        for fold in FOLDS {
            let packed =
                fs::read_to_string(made.path("models").join(format!("{fold}.safetensors")));
            let run = made.path(&format!("benchmark/{fold}-full-{expected}/run"));
            assert_eq!(packed.unwrap(), format!("pack {}", run.display()));
            let one = &reported[fold];
            assert_eq!(one["min_ade"], 0.1 + f64::from(expected));
            assert_eq!(one["min_fde"], 2.0 * (0.1 + f64::from(expected)));
            assert_eq!(
                (&one["seed"], &one["commit"]),
                (&json!(expected), &json!("0123abc"))
            );
            assert_eq!(
                (&one["protocol"], &one["test_walkers"]),
                (&json!("fair"), &json!(2500))
            );
            assert!(one["walkers"].as_u64().unwrap() >= 1000);
        }
        assert_eq!(reported.as_object().unwrap().len(), 5);
    }
}

#[test]
fn half_a_benchmark_is_refused() {
    let few = Made::new("star", &FOLDS[..4]).error();
    assert!(few.contains("zara2") && few.contains("all folds"), "{few}");
    let other = Made::new("social-gan", &FOLDS).error();
    assert!(other.contains("social-gan"), "{other}");
    let short = Made::of_profile("quick", "star", &FOLDS).error();
    assert!(short.contains("of profile quick"), "{short}");

    let made = Made::new("star", &FOLDS);
    let report = made.path("benchmark/univ-full-1/run/report.json");
    fs::write(&report, r#"{"rows": []}"#).unwrap();
    let older = made.error();
    assert!(
        older.contains("univ-full-1") && older.contains(FORECASTER),
        "{older}"
    );
    fs::remove_file(&report).unwrap();
    assert!(made.error().contains("finished"), "{}", made.error());
    fs::remove_file(made.path("benchmark/plan.json")).unwrap();
    assert!(made.error().contains("xtask benchmark"), "{}", made.error());
}

#[test]
fn nothing_is_replaced_unless_every_fold_can_be_packed() {
    let made = Made::new("star", &FOLDS);
    let whole = "printf x > \"$5\"";
    for (script, said) in [
        (
            "case \"$3\" in *zara2*) exit 1;; *) printf x > \"$5\";; esac",
            "above",
        ),
        ("head -c 2000001 /dev/zero > \"$5\"", "2000001 bytes"),
    ] {
        made.program(script);
        let error = made.error();
        assert!(error.contains(said), "{error}");
        assert!(!made.path("models").exists());
    }
    made.program(whole);
    made.make(None).unwrap();
    assert!(made.path("models/zara2.safetensors").is_file());
}
