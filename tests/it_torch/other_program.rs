//! `ddl windows` and `ddl evaluate --forecasts`: another program's forecasts, end to end.

use ddl::Variant;
use ddl::data::{Format, WindowRule, parse_recording};
use ddl::eval::ResultRow;
use ddl::eval::external::{self, Coverage, ExternalFormat};
use ddl::report::Report;
use ddl_tests::program::{self, Finished};
use ddl_tests::{other_program, own_tracks, recordings, tiny_model};
use std::path::Path;

const BASELINE: &str = "constant velocity (last step)";

fn row<'a>(report: &'a Report, protocol: &str, forecaster: &str) -> &'a ResultRow {
    let of = |row: &&ResultRow| {
        row.conditions.protocol.name() == protocol && row.conditions.forecaster == forecaster
    };
    report.rows().iter().find(of).unwrap()
}

/// The example's row and the baseline's agree, under both protocols.
fn check(report: &Report, name: &str) {
    for protocol in ["fair", "single"] {
        let (mine, baseline) = (row(report, protocol, name), row(report, protocol, BASELINE));
        assert_eq!(mine.scores.pedestrians, baseline.scores.pedestrians);
        for (a, b) in [
            (mine.scores.min_ade, baseline.scores.min_ade),
            (mine.scores.min_fde, baseline.scores.min_fde),
            (mine.scores.joint_ade, baseline.scores.joint_ade),
            (mine.scores.collision_rate, baseline.scores.collision_rate),
        ] {
            assert!((a - b).abs() < 1e-9, "{protocol}: {a} and {b}");
        }
    }
}

#[test]
fn the_python_example_is_scored_as_the_baseline_on_real_recordings() {
    let Some(data) = recordings::star_folder() else {
        return;
    };
    for (fold, printed, walkers) in [
        ("zara1", "0.428/0.953", 2324),
        ("hotel", "0.325/0.615", 1026),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let here = folder.path();
        let run = |command_line: &str| {
            let mut command = program::command(here, command_line);
            let output = command.arg("--data").arg(&data).output().unwrap();
            Finished::new(format!("ddl {command_line}"), &output).succeeds()
        };
        let windows = format!("windows --convention star --fold {fold} --output windows.jsonl");
        assert_eq!(run(&windows), "");
        if !other_program::forecasts_in(here) {
            return;
        }
        let summary = run(&format!(
            "evaluate --forecasts forecasts.jsonl --convention star --fold {fold} --name mine --out results"
        ));
        let line = summary
            .lines()
            .find(|line| line.ends_with("  mine"))
            .unwrap();
        assert!(
            line.contains(printed) && line.contains(&walkers.to_string()),
            "{line}"
        );
        let report = Report::load(&here.join("results/report.json")).unwrap();
        check(&report, "mine");
        let selection = row(&report, "fair", "mine").conditions.selection.as_deref();
        assert_eq!(
            selection,
            Some("made by another program, read from forecasts.jsonl")
        );
        assert_eq!(row(&report, "fair", "mine").scores.pedestrians, walkers);
        assert_eq!(
            row(&report, "fair", "mine").conditions.window_rule,
            WindowRule::Published
        );
        let page = std::fs::read_to_string(here.join("results/report.md")).unwrap();
        assert!(page.contains("| mine ") && page.contains(printed), "{page}");
    }
}

/// A folder with the windows of a simulated crowd and the example's forecasts of them.
fn simulated() -> Option<tempfile::TempDir> {
    let folder = tempfile::tempdir().unwrap();
    let windows = "windows --convention simulated --fold plaza --output windows.jsonl";
    assert_eq!(program::run(folder.path(), windows).succeeds(), "");
    other_program::forecasts_in(folder.path()).then_some(folder)
}

const EVALUATE: &str = "evaluate --convention simulated --fold plaza --forecasts";

#[test]
fn a_part_of_the_walkers_is_scored_only_when_asked_for() {
    let Some(folder) = simulated() else { return };
    let here = folder.path();
    let summary = program::run(here, &format!("{EVALUATE} forecasts.jsonl --out whole")).succeeds();
    assert!(summary.contains("  forecasts\n"), "{summary}");
    check(
        &Report::load(&here.join("whole/report.json")).unwrap(),
        "forecasts",
    );

    let text = std::fs::read_to_string(here.join("forecasts.jsonl")).unwrap();
    let some: Vec<&str> = text.lines().skip(7).collect();
    std::fs::write(here.join("some.jsonl"), some.join("\n")).unwrap();
    let message = program::run(here, &format!("{EVALUATE} some.jsonl --out part")).fails();
    let count = text.lines().count();
    for needle in [
        format!("some.jsonl forecasts {} of the {count} walkers", count - 7),
        "--intersection".to_owned(),
        "rule complete".to_owned(),
    ] {
        assert!(message.contains(&needle), "{needle} is not in: {message}");
    }
    assert!(!here.join("part").exists());
    let part = format!("{EVALUATE} some.jsonl --intersection --out part");
    let summary = program::run(here, &part).succeeds();
    assert!(
        summary.contains(
            "  some
"
        ),
        "{summary}"
    );
    let report = Report::load(&here.join("part/report.json")).unwrap();
    check(&report, "some");
    // Then a digest of who they are, the same in every row.
    let subset = format!(
        "walkers forecast by some.jsonl: {} of {count}, digest ",
        count - 7
    );
    let first = report.rows()[0].conditions.test_subset.clone();
    assert!(first.as_deref().unwrap().starts_with(&subset), "{first:?}");
    for row in report.rows() {
        assert_eq!(row.conditions.test_subset, first);
        assert_eq!(row.scores.pedestrians, count - 7);
    }
}

#[test]
fn what_cannot_be_measured_is_refused_with_the_reason() {
    let Some(folder) = simulated() else { return };
    let here = folder.path();
    for (arguments, needle) in [
        (
            "forecasts.jsonl --protocol published",
            "inside the forecaster",
        ),
        ("nowhere.jsonl", "cannot read nowhere.jsonl"),
        ("forecasts.csv", "cannot read forecasts.csv"),
        (
            "windows.jsonl",
            "windows.jsonl, line 1, hypotheses: is missing",
        ),
        (
            "forecasts.jsonl --window-rule published",
            "forecasts are of nobody in the windows",
        ),
    ] {
        let message = program::run(here, &format!("{EVALUATE} {arguments}")).fails();
        assert!(message.contains(needle), "{arguments}: {message}");
    }
    let other = "evaluate --convention simulated --fold doorway --forecasts forecasts.jsonl";
    let message = program::run(here, other).fails();
    assert!(
        message.contains("the windows are of doorway, the file also of plaza"),
        "{message}"
    );
    let message = program::run(here, "windows --convention simulated").fails();
    assert!(message.contains("corridor, crossing, plaza"), "{message}");
    let message = program::run(here, "evaluate").fails();
    assert!(message.contains("--data"), "{message}");
    for wrong in [
        "evaluate --model run --forecasts forecasts.jsonl",
        "evaluate --model run --fold plaza",
        "evaluate --forecasts forecasts.jsonl --fold plaza --window-rule all",
    ] {
        assert_eq!(program::run(here, wrong).code, Some(2), "{wrong}");
    }
}

/// Both formats that `ddl forecast` writes are formats that are read, as they are.
#[test]
fn what_ddl_forecast_writes_is_read_back() {
    let run = tiny_model::folder(Variant::Full);
    let rows = own_tracks::three_people(20);
    let tracks = own_tracks::csv(&rows);
    let recording = parse_recording(tracks.as_bytes(), "tracks", Format::Table).unwrap();
    let windows = recording.windows(WindowRule::Complete);
    assert_eq!(windows.len(), 1);
    let read = |options: &str, format: ExternalFormat| {
        let text = forecast(run.path(), &rows, options);
        let coverage = Coverage::Intersection; // other moments than the one with a future are forecast too
        external::read_from(text.as_bytes(), "f", format, &windows, coverage).unwrap()
    };
    let plain = read("--format jsonl", ExternalFormat::JsonLines);
    assert_eq!(plain.forecasts[0].hypotheses(), 20);
    assert!(plain.forecasts[0].has_goals() && plain.test_subset().is_none());
    let certified = read("--format jsonl --certificate", ExternalFormat::JsonLines);
    assert_eq!(certified.forecasts, plain.forecasts);
    for options in ["--format csv", "--format csv --certificate"] {
        let table = read(options, ExternalFormat::Table);
        for (i, k) in (0..3).flat_map(|i| (0..20).map(move |k| (i, k))) {
            let (a, b) = (&table.forecasts[0], &plain.forecasts[0]);
            let mut pairs = a.hypothesis(i, k).iter().zip(b.hypothesis(i, k));
            assert!(pairs.all(|(a, b)| own_tracks::alike_in_a_table(*a, *b)));
            assert_eq!(a.weight(i, k).to_bits(), b.weight(i, k).to_bits());
        }
    }
}

/// Tracks in the words of TrajNet++ are forecast as the same tracks in a table.
#[test]
fn tracks_of_trajnet_are_forecast_as_they_are() {
    let run = tiny_model::folder(Variant::Full);
    let rows = own_tracks::three_people(9);
    let table = forecast(run.path(), &rows, "");
    let lines: Vec<String> = rows
        .iter()
        .map(|(f, p, x, y)| {
            format!("{{\"track\": {{\"f\": {f}, \"p\": {p}, \"x\": {x}, \"y\": {y}}}}}")
        })
        .collect();
    std::fs::write(run.path().join("tracks.ndjson"), lines.join("\n")).unwrap();
    let command_line = "forecast --model . tracks.ndjson --whole --threads 1";
    assert_eq!(program::run(run.path(), command_line).succeeds(), table);
}

fn forecast(folder: &Path, rows: &[own_tracks::Row], options: &str) -> String {
    program::forecast(folder, rows, options).succeeds()
}
