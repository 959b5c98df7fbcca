//! `ddl windows` and `ddl evaluate --forecasts`: external forecasts, end to end.

use ddl::data::{Format, WindowRule, parse_recording};
use ddl::eval::external::{self, Coverage, ExternalFormat};
use ddl::eval::{ResultRow, Scores};
use ddl::report::Report;
use ddl_tests::place::Place;
use ddl_tests::skip::skip;
use ddl_tests::{own_tracks, recordings};
use std::path::Path;
use std::process::Command;

const BASELINE: &str = "constant velocity (last step)";
const EVALUATE: &str = "evaluate --convention simulated --fold plaza --forecasts";

/// Runs the example of `docs/your-model.md`, constant velocity in Python, on `windows.jsonl`. Returns false, with the
/// reason printed, if there is no Python, which CI must have.
fn python_forecasts(place: &Place) -> bool {
    let examples = Path::new(env!("CARGO_MANIFEST_DIR")).join("../crates/ddl-cli/examples");
    let output = Command::new("python3")
        .arg(examples.join("constant_velocity.py"))
        .args(["windows.jsonl", "forecasts.jsonl"])
        .current_dir(place.path())
        .output();
    match output {
        Ok(output) => {
            assert!(output.status.success(), "{output:?}");
            true
        }
        Err(error) => skip(format!("python3 cannot be started: {error}")).unwrap_or(false),
    }
}

/// The one row of a forecaster under a protocol.
pub(crate) fn row<'a>(report: &'a Report, protocol: &str, forecaster: &str) -> &'a ResultRow {
    let is_row =
        |row: &&ResultRow| row.conditions.protocol.name() == protocol && row.conditions.forecaster == forecaster;
    let rows: Vec<&ResultRow> = report.rows().iter().filter(is_row).collect();
    assert_eq!(rows.len(), 1, "rows of {forecaster}");
    rows[0]
}

fn report(place: &Place, folder: &str, name: &str) -> Report {
    let report = Report::load(&place.at(folder).join("report.json")).unwrap();
    for protocol in ["fair", "single"] {
        let [mine, baseline] = [name, BASELINE].map(|name| &row(&report, protocol, name).scores);
        assert_eq!(mine.pedestrians, baseline.pedestrians);
        let errors =
            |of: &Scores| [of.min_ade, of.min_fde, of.joint_ade, of.joint_fde, of.miss_rate, of.collision_rate];
        for (a, b) in errors(mine).into_iter().zip(errors(baseline)) {
            assert!((a - b).abs() < 1e-9, "{protocol}: {a} and {b}");
        }
    }
    report
}

/// An independent program computed the numbers of constant velocity under the published rule.
#[test]
fn the_python_example_has_the_scores_of_the_baseline_on_real_recordings() {
    let Some(data) = recordings::star_folder() else {
        return;
    };
    for (fold, printed, pedestrians) in [("zara1", "0.428/0.953", 2324), ("hotel", "0.325/0.615", 1026)] {
        let place = Place::empty();
        let recordings_of_fold = format!("--convention star --fold {fold} --data {}", data.display());
        let windows = format!("windows {recordings_of_fold} --output windows.jsonl");
        assert_eq!(place.ok(&windows), "");
        if !python_forecasts(&place) {
            return;
        }
        let evaluate = "evaluate --forecasts forecasts.jsonl --name mine --out results";
        let summary = place.ok(&format!("{evaluate} {recordings_of_fold}"));
        let line = summary.lines().find(|line| line.ends_with("  mine")).unwrap();
        let is_expected = line.contains(printed) && line.contains(&pedestrians.to_string());
        assert!(is_expected, "{line}");
        let report = report(&place, "results", "mine");
        let mine = row(&report, "fair", "mine");
        let selection = mine.conditions.selection.as_deref().unwrap();
        assert_eq!(selection, "made by another program");
        assert_eq!(mine.scores.pedestrians, pedestrians);
        assert_eq!(mine.conditions.window_rule, WindowRule::Published);
        let page = place.text("results/report.md");
        assert!(page.contains("| mine ") && page.contains(printed), "{page}");
    }
}

/// A folder with the windows of a simulated crowd and the example's forecasts.
fn simulated() -> Option<Place> {
    let place = Place::empty();
    let windows = "windows --convention simulated --fold plaza --output windows.jsonl";
    assert_eq!(place.ok(windows), "");
    python_forecasts(&place).then_some(place)
}

#[test]
fn a_part_of_the_pedestrians_is_scored_only_on_request() {
    let Some(place) = simulated() else { return };
    let summary = place.ok(&format!("{EVALUATE} forecasts.jsonl --out whole"));
    assert!(summary.contains("  forecasts\n"), "{summary}");
    let _ = report(&place, "whole", "forecasts");

    let text = place.text("forecasts.jsonl");
    let some: Vec<&str> = text.lines().skip(7).collect();
    place.write("some.jsonl", some.join("\n"));
    let part = format!("{EVALUATE} some.jsonl --out part");
    let (count, whole_count) = (some.len(), some.len() + 7);
    let missing = format!("some.jsonl forecasts {count} of the {whole_count} pedestrians");
    place.fails(&part, &[&missing, "--intersection", "rule complete"]);
    let summary = place.ok(&format!("{part} --intersection"));
    assert!(summary.contains("  some\n"), "{summary}");
    let report = report(&place, "part", "some");
    // Followed by a digest of the pedestrians, the same in every row.
    let subset = format!("pedestrians forecast by another program: {count} of {whole_count}, digest ");
    let first = &report.rows()[0].conditions.test_subset;
    assert!(first.as_deref().unwrap().starts_with(&subset), "{first:?}");
    for row in report.rows() {
        assert_eq!(&row.conditions.test_subset, first);
        assert_eq!(row.scores.pedestrians, count);
    }
}

#[test]
fn invalid_evaluations_are_refused_with_the_reason() {
    let Some(place) = simulated() else { return };
    let cases = "
forecasts.jsonl --protocol published => the forecaster chooses the goal
nowhere.jsonl => cannot read nowhere.jsonl
forecasts.csv => cannot read forecasts.csv
windows.jsonl => windows.jsonl, line 1, hypotheses: is missing
forecasts.jsonl --window-rule published => match no pedestrian of the windows
";
    place.all_fail(EVALUATE, cases);
    let other_fold = "evaluate --convention simulated --fold doorway --forecasts forecasts.jsonl";
    place.fails(other_fold, &["the windows are of doorway, the file also of plaza"]);
}

#[test]
fn the_output_of_ddl_forecast_is_read_back() {
    let place = Place::with_model();
    let rows = own_tracks::three_pedestrians(20);
    let tracks = own_tracks::csv(&rows);
    let windows = parse_recording(tracks.as_bytes(), "tracks", Format::Table).unwrap().windows(WindowRule::Complete);
    assert_eq!(windows.len(), 1);
    let read = |options: &str, format: ExternalFormat| {
        let text = place.forecast(&rows, options).succeeds();
        let coverage = Coverage::Intersection; // moments without a known future are forecast as well
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
