//! `ddl train`, `ddl evaluate`, `ddl report`: the way of a number from the recordings to the page.

use ddl::data::{Convention, WindowRule};
use ddl::eval::ResultRow;
use ddl::network::EpochReport;
use ddl::report::{Moment, Report};
use ddl::{Protocol, RunDirectory};
use ddl_tests::folder_contents::{self, Contents};
use ddl_tests::program;
use serde::Deserialize;
use std::path::Path;

const TRAIN: &str = "train --convention simulated --fold plaza --recipe published --seed 5 --epochs 2 --train-walkers 200 \
                     --batch-walkers 64 --proposal-steps 10 --out run --threads 1";
const EVALUATE: &str = "evaluate --model run --protocol published --protocol fair --protocol single \
                        --test-walkers 60 --threads 1";

/// A line of `--progress json`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Progress {
    stage: String,
    done: f64,
    total: f64,
    message: String,
}

/// Runs a command with `--progress json` and `--commit`, and checks what it tells.
fn told(folder: &Path, command_line: &str) -> Vec<Progress> {
    let command_line = format!("{command_line} --progress json --commit 0123abc");
    let lines: Vec<Progress> = program::run(folder, &command_line)
        .succeeds()
        .lines()
        .map(|line| serde_json::from_str(line).unwrap())
        .collect();
    let verb = command_line.split(' ').next().unwrap();
    let stages: Vec<&[Progress]> = lines.chunk_by(|a, b| a.stage == b.stage).collect();
    let names: Vec<&str> = stages.iter().map(|lines| &*lines[0].stage).collect();
    // training trains the goals first
    let expected = if verb == "train" {
        &["goals", "train"][..]
    } else {
        &[verb]
    };
    assert!(names.is_empty() || names == expected, "{names:?}");
    for lines in stages {
        assert!(lines.iter().all(|line| !line.message.is_empty()));
        assert!(
            lines
                .iter()
                .all(|line| line.total > 0.0 && line.done <= line.total)
        );
        assert!(lines.windows(2).all(|pair| pair[0].done <= pair[1].done));
        assert!(
            lines
                .windows(2)
                .all(|pair| same(pair[0].total, pair[1].total))
        );
        if let Some(last) = lines.last() {
            assert!(same(last.done, last.total), "{verb} ended at {last:?}");
        }
    }
    lines
}

fn same(a: f64, b: f64) -> bool {
    a.to_bits() == b.to_bits()
}

/// Runs a command a second time: it has nothing to do, says nothing, and changes nothing.
fn returns_at_once(folder: &Path, command_line: &str) {
    let before: Contents = folder_contents::read(folder);
    assert!(
        told(folder, command_line).is_empty(),
        "worked a second time"
    );
    let after = folder_contents::read(folder);
    assert_eq!(
        folder_contents::differences(&before, &after),
        Vec::<String>::new()
    );
}

fn check_run(run: &Path) {
    let directory = RunDirectory::new(run);
    let files = [
        directory.model(),
        directory.optimizer(),
        directory.experts(),
        directory.epoch(1),
        directory.epoch(2),
        run.join("config.json"),
    ];
    for file in files {
        assert!(file.is_file(), "{} is missing", file.display());
    }
    let config = directory.config().unwrap();
    assert_eq!(config.data.convention, Convention::Simulated);
    assert_eq!(
        (config.data.fold.as_str(), config.training.seed),
        ("plaza", 5)
    );
    assert_eq!(config.commit, "0123abc");
    let metrics = std::fs::read_to_string(run.join("metrics.jsonl")).unwrap();
    let epochs: Vec<EpochReport> = metrics
        .lines()
        .map(|line| serde_json::from_str(line).unwrap())
        .collect();
    assert_eq!(epochs, directory.metrics().unwrap());
    let numbers: Vec<_> = epochs
        .iter()
        .map(|epoch| (epoch.epoch, epoch.batches))
        .collect();
    assert_eq!(numbers, [(1, 4), (2, 4)]);
    assert!(
        epochs
            .iter()
            .all(|epoch| epoch.loss.is_finite() && epoch.loss > 0.0)
    );
}

/// Every row names the conditions of its number.
fn check_conditions(row: &ResultRow) {
    let conditions = &row.conditions;
    assert_eq!(conditions.convention, Convention::Simulated);
    assert_eq!(conditions.window_rule, WindowRule::Complete);
    assert_eq!(conditions.fold, "plaza");
    assert_eq!(
        (conditions.device.as_str(), conditions.commit.as_str()),
        ("cpu", "0123abc")
    );
    assert!(!conditions.forecaster.is_empty());
    let subset = conditions.test_subset.as_deref().unwrap();
    assert!(subset.contains("60 walkers"), "{subset}");
    if !conditions.forecaster.starts_with("DDL") {
        return;
    }
    assert_eq!(conditions.variant.as_deref(), Some("full"));
    assert_eq!((conditions.seed, conditions.epochs), (Some(5), Some(2)));
    let training = conditions.training_subset.as_deref().unwrap();
    assert!(training.contains("200 walkers"), "{training}");
    let selection = conditions.selection.as_deref().unwrap();
    let on_test = conditions.protocol == Protocol::Published;
    assert_eq!(selection.contains("TEST"), on_test, "{selection}");
}

/// Stable steps are certified all; plain ones, published or not, are counted as they are.
fn check_certificates(protocol: Protocol, rows: &[&ResultRow]) {
    let stability = |forecaster: &str| {
        let row = rows
            .iter()
            .find(|row| row.conditions.forecaster == forecaster);
        row.map(|row| row.scores.stability.unwrap())
    };
    let model = stability("DDL").unwrap();
    let share = model.certified.unwrap();
    let plain = stability("DDL with plain Euler steps");
    assert_eq!(plain.is_some(), protocol == Protocol::Fair);
    if protocol.shows_future() {
        assert!(share < 1.0, "{protocol}: {model:?}");
    } else {
        assert!(same(share, 1.0), "{protocol}: {model:?}");
        assert!(same(model.decreasing, 1.0), "{protocol}: {model:?}");
    }
    if let Some(plain) = plain {
        assert!(plain.certified.unwrap() < 1.0, "{plain:?}");
        assert_eq!(plain.rollouts, model.rollouts);
    }
    let line = rows
        .iter()
        .find(|row| row.conditions.forecaster.starts_with("straight line to"));
    let Some(line) = line else {
        assert_eq!(protocol, Protocol::Single);
        return;
    };
    assert_ne!(protocol, Protocol::Single);
    assert_eq!(line.scores.stability.unwrap().certified, None);
    // The goals depend on the run: another seed has other lines.
    assert_eq!(line.conditions.seed, Some(5));
    assert!(
        line.conditions
            .recipe
            .as_deref()
            .unwrap()
            .starts_with("goals ")
    );
}

fn check_rows(rows: &[ResultRow]) {
    rows.iter().for_each(check_conditions);
    for protocol in Protocol::ALL {
        let of_protocol: Vec<&ResultRow> = rows
            .iter()
            .filter(|row| row.conditions.protocol == protocol)
            .collect();
        let model: Vec<_> = of_protocol
            .iter()
            .filter(|row| row.conditions.forecaster == "DDL")
            .collect();
        assert_eq!(model.len(), 1, "{protocol}");
        assert_eq!(model[0].scores.hypotheses, protocol.hypotheses());
        // The one forecast is a straight line itself; beside it stands what the network would make of the way.
        let beside = match protocol {
            Protocol::Single => "DDL on the way that its network shapes",
            _ => "straight line to",
        };
        for baseline in ["constant velocity", beside] {
            let named = |row: &&&ResultRow| row.conditions.forecaster.starts_with(baseline);
            assert!(
                of_protocol.iter().any(|row| named(&row)),
                "{protocol}: {baseline}"
            );
        }
        let walkers = model[0].scores.pedestrians;
        assert!((60..100).contains(&walkers), "{walkers}");
        if protocol == Protocol::Single {
            let shaped = of_protocol
                .iter()
                .find(|row| row.conditions.forecaster == beside)
                .unwrap();
            assert_eq!(shaped.scores.stability.unwrap().certified, Some(1.0));
            assert!(!same(shaped.scores.min_ade, model[0].scores.min_ade));
        }
        for row in &of_protocol {
            assert_eq!(
                row.scores.pedestrians, walkers,
                "{}",
                row.conditions.forecaster
            );
            assert!(row.scores.min_ade.is_finite() && row.scores.min_ade > 0.0);
            assert!(row.scores.min_fde <= row.scores.fde_at_min_ade);
        }
        check_certificates(protocol, &of_protocol);
    }
}

/// Moments to look at: what the model forecast under `fair`, certified, some of them picked to show something.
fn check_moments(run: &Path) {
    let text = std::fs::read_to_string(run.join("moments.json")).unwrap();
    let moments: Vec<Moment> = serde_json::from_str(&text).unwrap();
    assert!(!moments.is_empty());
    assert!(moments.iter().any(|moment| !moment.picks.is_empty()));
    for moment in &moments {
        assert_eq!(
            (moment.fold.as_str(), moment.forecaster.as_str()),
            ("plaza", "DDL")
        );
        for hypothesis in moment.pedestrians.iter().flat_map(|one| &one.hypotheses) {
            assert_eq!(
                (hypothesis.certified, hypothesis.decreasing),
                (Some(true), Some(true))
            );
        }
    }
}

#[test]
fn a_number_goes_from_the_recordings_to_the_page() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let run = here.join("run");

    // 200 walkers in batches of 64: 4 steps an epoch
    let mut steps = told(here, TRAIN);
    steps.retain(|step| step.stage == "train");
    assert_eq!(steps.len(), 8);
    assert!(steps[7].message.contains("epoch 2"));
    check_run(&run);
    returns_at_once(here, TRAIN);

    let walkers = told(here, EVALUATE);
    assert!(walkers.len() >= 2);
    let report = Report::load(&run.join("report.json")).unwrap();
    check_rows(report.rows());
    returns_at_once(here, EVALUATE);

    check_moments(&run);

    let baselines = "baselines --convention simulated --fold doorway --test-walkers 60 --commit 0123abc --out baselines";
    let printed = program::run(here, baselines).succeeds();
    assert!(printed.contains("doorway") && printed.contains("constant velocity (last step)"));
    let elsewhere = Report::load(&here.join("baselines/report.json")).unwrap();
    let folds: Vec<&str> = elsewhere
        .rows()
        .iter()
        .map(|r| r.conditions.fold.as_str())
        .collect();
    assert!(!folds.is_empty() && folds.iter().all(|fold| *fold == "doorway"));

    let page = "report run baselines --title Plaza --out pages";
    let told = program::run(here, page).succeeds();
    assert!(told.ends_with("report.html\n") && told.lines().count() == 1);
    let collected = Report::load(&here.join("pages/report.json")).unwrap();
    assert_eq!(collected.title(), "Plaza");
    assert_eq!(collected.rows(), [report.rows(), elsewhere.rows()].concat());
    let latex = std::fs::read_to_string(here.join("pages/report.tex")).unwrap();
    assert!(latex.contains("\\begin{tabular}") && latex.contains("\\texttt{fair}"));
    let markdown = std::fs::read_to_string(here.join("pages/report.md")).unwrap();
    assert!(markdown.lines().next().unwrap().contains("simulated"));
    let warning = Protocol::Published.warning().unwrap();
    for text in [
        "Plaza",
        "`fair`",
        "`single`",
        "`published`",
        "0123abc",
        "certified %",
        "| DDL with plain Euler steps ",
        warning,
    ] {
        assert!(markdown.contains(text), "{text} is not on the page");
    }
}
