//! `ddl forecast`: a user's own tracks in, hypotheses and certificates out.

use ddl::data::Position;
use ddl::dynamics::LyapunovCertificate;
use ddl::{BuiltinModel, Variant};
use ddl_core::distance;
use ddl_tests::own_tracks::{self, FRAME_STEP, Row};
use ddl_tests::place::{Place, json_lines};
use serde::Deserialize as _;
use serde_json::{Value, json};
use std::collections::BTreeMap;

const HYPOTHESES: usize = 20;
const FRAMES: usize = 12;
const COLUMNS: &str = "observed_until,pedestrian,hypothesis,weight,goal_x,goal_y,frame,x,y,unseen,age,uncertainty,\
                       familiarity,distance_to_goal,certified";

type CsvRow = BTreeMap<String, Value>;

fn table(text: &str) -> Vec<CsvRow> {
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    reader.deserialize().collect::<Result<_, _>>().unwrap()
}

fn numbers<const N: usize>(row: &CsvRow, names: [&str; N]) -> [f64; N] {
    names.map(|name| row[name].as_f64().unwrap())
}

/// Asserts that the fields of an object are these ones, and no others.
fn has_fields(object: &Value, names: &str) {
    let mut fields: Vec<&str> = object.as_object().unwrap().keys().map(String::as_str).collect();
    fields.sort_unstable();
    assert_eq!(fields.join(" "), names);
}

/// Compares the certificate of a hypothesis with the positions printed beside it, and returns the distances to the goal
/// after each step.
fn check_certificate(start: Position, hypothesis: &Value) -> Vec<f64> {
    let (value, positions) = (&hypothesis["certificate"], &hypothesis["positions"]);
    let certificate = LyapunovCertificate::<f64>::deserialize(value).unwrap();
    assert_eq!(certificate.verify(), Ok(()));
    assert_eq!(json!([value["holds"], value["violation"]]), json!([true, null]));
    let goal = Position::deserialize(&hypothesis["goal"]).unwrap();
    assert_eq!(certificate.goal(), goal);
    for (name, number) in [
        ("min_eigenvalue", certificate.min_eigenvalue()),
        ("min_step_margin", certificate.min_step_margin()),
        ("largest_angle", Some(certificate.largest_angle())),
    ] {
        assert_eq!(value[name].as_f64(), number, "{name}");
    }
    let path = Vec::<Position>::deserialize(positions).unwrap();
    let left: Vec<f64> = [start].iter().chain(&path).map(|&p| distance(p, goal)).collect();
    let potentials: Vec<f64> = certificate.potentials().collect();
    assert_eq!(potentials.len(), left.len());
    let mut pairs = left.iter().zip(&potentials);
    assert!(pairs.all(|(left, potential)| (left - potential).abs() < 1e-12));
    potentials[1..].to_vec()
}

#[test]
fn the_extension_of_the_output_is_its_format_and_a_dash_is_standard_output() {
    let place = Place::with_model();
    let forecast = "forecast --model run tracks.csv";
    let lines = place.ok(&format!("{forecast} --format jsonl"));
    let _ = place.ok(&format!("{forecast} --output out.jsonl"));
    assert_eq!(place.text("out.jsonl"), lines);
    let table = place.ok(forecast);
    assert_eq!(place.ok(&format!("{forecast} --output -")), table);
    let _ = place.ok(&format!("{forecast} --output given.jsonl --format csv"));
    assert_eq!(place.text("given.jsonl"), table);
    assert!(!place.at("-").exists());
}

fn assert_changes_no_other_column(certified: &str, plain: &str) {
    let cut = |line: &str| line.split(',').take(13).collect::<Vec<_>>().join(",");
    let cut: Vec<String> = certified.lines().map(cut).collect();
    assert_eq!(plain.lines().collect::<Vec<_>>(), cut);
    assert_eq!(certified.lines().next(), Some(COLUMNS));
}

#[test]
fn every_format_has_the_same_hypotheses_and_certificates() {
    let place = Place::with_model();
    let tracks = own_tracks::three_pedestrians(10);
    let position_at =
        |moment, id| tracks.iter().find(|row| (row.0, row.1) == (moment, id)).map(|&(.., x, y)| [x, y]).unwrap();
    let forecast = |options: &str| place.forecast(&tracks, options).succeeds();
    let mut lines: Vec<Value> = json_lines(&forecast("--format jsonl --certificate"));
    let certified = forecast("--certificate");
    let mut rows = table(&certified).into_iter();
    let mut pedestrians = [70, 80, 90].into_iter().flat_map(|moment| [1, 2, 3].map(|id| (moment, id)));
    for line in &mut lines {
        has_fields(line, "age familiarity frames hypotheses observed_until pedestrian spread uncertainty unseen");
        let (moment, id) = pedestrians.next().unwrap();
        assert_eq!(json!([line["observed_until"], line["pedestrian"]]), json!([moment, id]));
        let frames: Vec<i64> = (1..=12).map(|t| moment + t * FRAME_STEP).collect();
        assert_eq!(line["frames"], json!(frames));
        let familiarity = line["familiarity"].as_f64().unwrap();
        assert!(familiarity > 0.0 && familiarity <= 1.0);
        let spread = Vec::<f64>::deserialize(&line["spread"]).unwrap();
        assert!(spread.is_sorted() && spread.len() == FRAMES);
        assert_eq!(json!([line["unseen"], line["age"], line["uncertainty"]]), json!([0, 0.0, 0.0]));
        let hypotheses = line["hypotheses"].as_array_mut().unwrap();
        assert_eq!(hypotheses.len(), HYPOTHESES);
        let weights: f64 = hypotheses.iter().map(|one| one["weight"].as_f64().unwrap()).sum();
        assert!((weights - 1.0).abs() < 1e-9);
        for (k, hypothesis) in hypotheses.iter_mut().enumerate() {
            has_fields(hypothesis, "certificate goal positions weight");
            let left = check_certificate(position_at(moment, id), hypothesis);
            for (t, frame) in frames.iter().enumerate() {
                let row = rows.next().unwrap();
                let place = ["observed_until", "pedestrian", "hypothesis", "frame"].map(|name| &row[name]);
                assert_eq!(json!(place), json!([moment, id, k, frame]));
                for (printed, position) in
                    [(["x", "y"], &hypothesis["positions"][t]), (["goal_x", "goal_y"], &hypothesis["goal"])]
                {
                    let position = Position::deserialize(position).unwrap();
                    assert!(own_tracks::alike_in_a_table(numbers(&row, printed), position));
                }
                // Rounded to three digits.
                assert!((numbers(&row, ["familiarity"])[0] / familiarity - 1.0).abs() < 6e-3);
                let found = numbers(&row, ["weight", "unseen", "age", "uncertainty", "distance_to_goal"]);
                assert_eq!(json!(found), json!([hypothesis["weight"], 0.0, 0.0, 0.0, left[t]]));
                assert_eq!(row["certified"], true);
            }
            hypothesis.as_object_mut().unwrap().remove("certificate");
        }
    }
    assert!(rows.next().is_none() && pedestrians.next().is_none());
    assert_changes_no_other_column(&certified, &forecast(""));
    assert_eq!(json_lines::<Value>(&forecast("--format jsonl")), lines);
}

#[test]
fn a_forecast_does_not_depend_on_other_windows() {
    let place = Place::empty();
    let rows = own_tracks::three_pedestrians(12);
    let mut from_west_to_east = rows.clone();
    from_west_to_east.sort_by(|one, other| one.2.total_cmp(&other.2));
    assert_ne!(rows, from_west_to_east);
    let end: Vec<Row> = rows.iter().filter(|row| row.0 >= 40).copied().collect();
    place.write_tracks("rows.csv", &rows);
    place.write_tracks("shuffled.csv", &from_west_to_east);
    place.write_tracks("end.csv", &end);
    let unnamed = place.ok("forecast rows.csv --whole");
    assert_eq!(unnamed.lines().count(), 1 + 5 * 3 * HYPOTHESES * FRAMES);
    for model in BuiltinModel::ALL {
        let forecast = |rest: &str| place.ok(&format!("forecast --model {model} --whole {rest}"));
        let [table, lines] = ["csv", "jsonl"].map(|format| {
            let output = forecast(&format!("rows.csv --format {format} --threads 1"));
            for other in ["shuffled.csv --threads 1", "rows.csv --threads 2"] {
                let other = forecast(&format!("{other} --format {format}"));
                assert!(output == other, "{model}");
            }
            output
        });
        assert_eq!(table == unnamed, model == BuiltinModel::default(), "{model}");
        let last: Vec<&str> = lines.lines().skip(4 * 3).collect();
        for alone in ["rows.csv --last --threads 1", "end.csv --threads 2"] {
            let alone = forecast(&format!("{alone} --format jsonl"));
            assert_eq!(alone.lines().collect::<Vec<_>>(), last, "{model}");
        }
    }
}

/// Map coordinates are millions of metres, where numbers are 1e-9 m apart. A forecast there is the shifted forecast at
/// the origin, and its certificates hold.
#[test]
fn forecasts_move_with_the_origin_of_the_map() {
    let rows = own_tracks::three_pedestrians(8);
    let [east, north] = [500_000.0, 4_600_000.0];
    let moved = |&(frame, id, x, y): &Row| (frame, id, x + east, y + north);
    let moved: Vec<Row> = rows.iter().map(moved).collect();
    for variant in [Variant::Full, Variant::NoGoalShift] {
        let place = Place::with_variant(variant);
        let forecast = |rows| table(&place.forecast(rows, "--certificate").succeeds());
        let there = forecast(&moved);
        assert_eq!(there.len(), 3 * HYPOTHESES * FRAMES);
        for (here, there) in forecast(&rows).iter().zip(&there) {
            let ([x, y], [there_x, there_y]) = (numbers(here, ["x", "y"]), numbers(there, ["x", "y"]));
            let off = (x + east - there_x).hypot(y + north - there_y);
            assert!(off < 1e-3, "{variant}: off by {off} m");
        }
        for hypothesis in there.chunks_exact(FRAMES) {
            assert!(hypothesis.iter().all(|row| row["certified"] == true));
            let left: Vec<f64> = hypothesis.iter().map(|row| numbers(row, ["distance_to_goal"])[0]).collect();
            assert!(left.windows(2).all(|pair| pair[1] < pair[0] || pair[0] == 0.0), "{left:?}");
        }
    }
}

#[test]
fn regions_are_written_as_radii_and_as_discs() {
    let place = Place::with_model();
    let line = "forecast --model run tracks.csv --whole --last --region 0.5,0.9";
    let table = place.ok(line);
    let (header, rows) = table.split_once('\n').unwrap();
    assert!(header.ends_with("familiarity,radius_0.5,radius_0.9"), "{header}");
    let mut of_table = 0;
    for row in rows.lines() {
        let fields: Vec<&str> = row.split(',').collect();
        let [half, most] = [13, 14].map(|field: usize| fields[field].parse().unwrap_or(0.0));
        assert!(most >= half && half >= 0.0, "{row}");
        of_table += usize::from(most > 0.0);
    }
    let mut of_lines = 0;
    for line in json_lines::<Value>(&place.ok(&format!("{line} --format jsonl"))) {
        let regions = line["regions"].as_array().unwrap();
        let levels: Vec<_> = regions.iter().map(|region| &region["probability"]).collect();
        assert_eq!(levels, [0.5, 0.9]);
        let discs: Vec<Vec<[f64; 3]>> = serde_json::from_value(regions[1]["discs"].clone()).unwrap();
        let largest = |step: usize| discs[step].iter().map(|disc| disc[2]).fold(0.0, f64::max);
        assert!(largest(0) > 0.0 && largest(11) > largest(0));
        of_lines += discs.iter().map(Vec::len).sum::<usize>();
    }
    assert_eq!(of_table, of_lines);
}
