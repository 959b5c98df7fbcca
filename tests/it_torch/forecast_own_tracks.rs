//! `ddl forecast`: a user's own tracks in, hypotheses out.

use ddl::Variant;
use ddl_tests::own_tracks::{self, FRAME_STEP, Row};
use ddl_tests::{folder_contents, program, tiny_model};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::Path;

/// Hypotheses a pedestrian, and frames of each.
const HYPOTHESES: usize = 20;
const FRAMES: usize = 12;

/// A row of the csv.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct CsvRow {
    observed_until: i64,
    pedestrian: i64,
    hypothesis: usize,
    weight: f64,
    goal_x: f64,
    goal_y: f64,
    frame: i64,
    x: f64,
    y: f64,
    padded: usize,
    filled: usize,
    familiarity: f64,
}

/// A line of the JSON lines.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct JsonLine {
    observed_until: i64,
    pedestrian: i64,
    padded: usize,
    filled: usize,
    frames: Vec<i64>,
    familiarity: f64,
    #[serde(default)]
    spread: Vec<f64>,
    hypotheses: Vec<Hypothesis>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Hypothesis {
    weight: f64,
    goal: Option<[f64; 2]>,
    positions: Vec<[f64; 2]>,
}

/// Forecasts rows with the tiny model, in the folder of its run.
fn forecast_in(folder: &Path, rows: &[Row], options: &str) -> String {
    program::forecast(folder, rows, options).succeeds()
}

fn forecast(rows: &[Row], options: &str) -> String {
    forecast_in(tiny_model::folder(Variant::Full).path(), rows, options)
}

fn json_lines(rows: &[Row]) -> Vec<JsonLine> {
    let text = forecast(rows, "--format jsonl");
    text.lines()
        .map(|line| serde_json::from_str(line).unwrap())
        .collect()
}

fn csv_rows(text: &str) -> Vec<CsvRow> {
    csv::Reader::from_reader(text.as_bytes())
        .deserialize()
        .collect::<Result<_, _>>()
        .unwrap()
}

#[test]
fn csv_holds_twenty_weighted_futures_of_twelve_frames() {
    let text = forecast(&own_tracks::three_people(10), "");
    let mut futures: BTreeMap<(i64, i64), Vec<CsvRow>> = BTreeMap::new();
    for row in csv_rows(&text) {
        assert!(row.x.is_finite() && row.y.is_finite(), "{row:?}");
        let walker = (row.observed_until, row.pedestrian);
        futures.entry(walker).or_default().push(row);
    }
    let moments = [70, 80, 90];
    let walkers: Vec<_> = moments
        .iter()
        .flat_map(|&moment| [1, 2, 3].map(|id| (moment, id)))
        .collect();
    assert_eq!(futures.keys().copied().collect::<Vec<_>>(), walkers);
    for ((moment, _), rows) in &futures {
        assert_eq!(rows.len(), HYPOTHESES * FRAMES);
        let frames: Vec<i64> = (1..=12).map(|t| moment + t * FRAME_STEP).collect();
        for (index, row) in rows.iter().enumerate() {
            assert_eq!(row.hypothesis, index / FRAMES);
            assert_eq!(row.frame, frames[index % FRAMES]);
        }
        let weights = rows.iter().step_by(FRAMES).map(|row| row.weight);
        assert!((weights.sum::<f64>() - 1.0).abs() < 1e-9);
        for hypothesis in rows.chunks_exact(FRAMES) {
            let weight = hypothesis[0].weight;
            assert!((0.0..=1.0).contains(&weight));
            assert!(
                hypothesis
                    .iter()
                    .all(|row| row.weight.to_bits() == weight.to_bits())
            );
        }
    }
}

#[test]
fn json_lines_hold_the_same_numbers_as_csv() {
    let people = own_tracks::three_people(9);
    let rows = csv_rows(&forecast(&people, "--format csv"));
    let mut rows = rows.iter();
    for line in json_lines(&people) {
        assert_eq!(line.hypotheses.len(), HYPOTHESES);
        for (k, hypothesis) in line.hypotheses.iter().enumerate() {
            assert_eq!(hypothesis.positions.len(), FRAMES);
            for (position, &frame) in hypothesis.positions.iter().zip(&line.frames) {
                let row = rows.next().unwrap();
                assert_eq!(
                    (
                        row.observed_until,
                        row.pedestrian,
                        row.hypothesis,
                        row.frame
                    ),
                    (line.observed_until, line.pedestrian, k, frame)
                );
                assert!(own_tracks::alike_in_a_table([row.x, row.y], *position));
                let goal = hypothesis.goal.unwrap();
                assert!(own_tracks::alike_in_a_table([row.goal_x, row.goal_y], goal));
                assert_eq!((row.padded, row.filled), (line.padded, line.filled));
                // to three digits
                assert!((row.familiarity / line.familiarity - 1.0).abs() < 6e-3);
                assert!(line.spread.is_sorted() && line.spread.len() == 12);
                assert_eq!((row.padded, row.filled), (0, 0));
                assert_eq!(row.weight.to_bits(), hypothesis.weight.to_bits());
            }
        }
    }
    assert!(rows.next().is_none());
}

#[test]
fn every_forecast_comes_nearer_to_its_goal_at_every_step() {
    let rows = own_tracks::three_people(10);
    let at = |frame, pedestrian| {
        let row = rows
            .iter()
            .find(|row| (row.0, row.1) == (frame, pedestrian));
        row.map(|&(_, _, x, y)| [x, y]).unwrap()
    };
    for line in json_lines(&rows) {
        for hypothesis in &line.hypotheses {
            let goal = hypothesis.goal.unwrap();
            let left = |p: [f64; 2]| (p[0] - goal[0]).hypot(p[1] - goal[1]);
            let mut before = left(at(line.observed_until, line.pedestrian));
            for &position in &hypothesis.positions {
                let after = left(position);
                assert!(after < before || after == 0.0, "{before} m, then {after} m");
                before = after;
            }
        }
    }
}

#[test]
fn the_order_of_rows_does_not_matter() {
    let rows = own_tracks::three_people(10);
    let shuffled = own_tracks::shuffled(&rows);
    assert_ne!(rows, shuffled);
    for format in ["csv", "jsonl"] {
        let options = format!("--format {format}");
        assert_eq!(forecast(&rows, &options), forecast(&shuffled, &options));
    }
}

#[test]
fn last_keeps_the_last_frame_alone() {
    let rows = own_tracks::three_people(12);
    let all = forecast(&rows, "--format jsonl");
    let last = forecast(&rows, "--format jsonl --last");
    let ends: Vec<&str> = all.lines().collect();
    assert_eq!(last.lines().count(), 3);
    let parse = |line: &str| serde_json::from_str::<JsonLine>(line).unwrap();
    for (expected, found) in ends[ends.len() - 3..].iter().zip(last.lines()) {
        let (expected, found) = (parse(expected), parse(found));
        assert_eq!(found.observed_until, expected.observed_until);
        // other windows in the batch, other rounding
        for (a, b) in expected.hypotheses.iter().zip(&found.hypotheses) {
            for (p, q) in a.positions.iter().zip(&b.positions) {
                assert!((p[0] - q[0]).abs() < 1e-3 && (p[1] - q[1]).abs() < 1e-3);
            }
        }
    }
}

/// Map coordinates are millions of metres: a forecast there is that at the origin, moved.
#[test]
fn forecasts_move_with_the_origin_of_the_map() {
    let rows = own_tracks::three_people(8);
    let [east, north] = [500_000.0, 4_600_000.0];
    let moved: Vec<Row> = rows
        .iter()
        .map(|&(frame, id, x, y)| (frame, id, x + east, y + north))
        .collect();
    let largest = csv_rows(&forecast(&rows, ""))
        .iter()
        .zip(csv_rows(&forecast(&moved, "")))
        .map(|(here, there)| (here.x + east - there.x).hypot(here.y + north - there.y))
        .fold(0.0, f64::max);
    assert!(largest < 1e-3, "off by up to {largest} m");
}

#[test]
fn output_goes_to_the_file_named_and_nowhere_else() {
    let folder = tiny_model::folder(Variant::Full);
    let rows = own_tracks::three_people(8);
    let printed = forecast_in(folder.path(), &rows, "");
    let before = folder_contents::read(folder.path());
    assert_eq!(forecast_in(folder.path(), &rows, "--output out.csv"), "");
    let after = folder_contents::read(folder.path());
    assert_eq!(
        folder_contents::differences(&before, &after),
        ["out.csv is new"]
    );
    let written = after[Path::new("out.csv")].clone().unwrap();
    assert_eq!(String::from_utf8(written).unwrap(), printed);
}

/// Regions: a radius a row in csv and discs in JSON lines, the same ones; the region of 90 % is the larger, and grows with time.
#[test]
fn regions_are_written_as_radii_and_as_discs() {
    let rows = own_tracks::three_people(9);
    let table = forecast(&rows, "--last --region 0.5,0.9");
    let mut lines = table.lines();
    let header = lines.next().unwrap();
    assert!(
        header.ends_with("familiarity,radius_0.5,radius_0.9"),
        "{header}"
    );
    let mut of_table = 0;
    for line in lines {
        let fields: Vec<&str> = line.split(',').collect();
        let [half, most] =
            [fields[12], fields[13]].map(|radius| radius.parse::<f64>().unwrap_or(0.0));
        assert!(most >= half && half >= 0.0, "{line}");
        of_table += usize::from(most > 0.0);
    }
    let mut of_lines = 0;
    for line in forecast(&rows, "--last --region 0.5,0.9 --format jsonl").lines() {
        let line: serde_json::Value = serde_json::from_str(line).unwrap();
        let regions = line["regions"].as_array().unwrap();
        let levels: Vec<f64> = regions
            .iter()
            .map(|r| r["probability"].as_f64().unwrap())
            .collect();
        assert_eq!(levels, [0.5, 0.9]);
        let largest = |step: usize| {
            let discs = regions[1]["discs"][step].as_array().unwrap().iter();
            discs
                .map(|disc| disc[2].as_f64().unwrap())
                .fold(0.0, f64::max)
        };
        assert!(largest(0) > 0.0 && largest(11) > largest(0));
        let steps = regions[1]["discs"].as_array().unwrap().iter();
        of_lines += steps
            .map(|discs| discs.as_array().unwrap().len())
            .sum::<usize>();
    }
    assert_eq!(of_table, of_lines);
    let refused = program::forecast(
        tiny_model::folder(Variant::Full).path(),
        &rows,
        "--region 1.5",
    );
    assert!(
        refused.stderr.contains("a region has a probability of"),
        "{refused:?}"
    );
}
