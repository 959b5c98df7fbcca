//! `ddl forecast`: a user's own tracks in, hypotheses and certificates out.

use ddl::data::Position;
use ddl::dynamics::LyapunovCertificate;
use ddl::{BuiltinModel, Variant};
use ddl_core::distance;
use ddl_tests::own_tracks::{self, FRAME_STEP, Row};
use ddl_tests::place::{Place, json_lines};
use serde::Deserialize;
use serde_json::Value;

const HYPOTHESES: usize = 20;
const FRAMES: usize = 12;

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
    unseen: usize,
    age: f64,
    uncertainty: f64,
    familiarity: f64,
    #[serde(default)]
    distance_to_goal: Option<f64>,
    #[serde(default)]
    certified: Option<bool>,
}

#[derive(Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
struct JsonLine {
    observed_until: i64,
    pedestrian: i64,
    unseen: usize,
    age: f64,
    uncertainty: f64,
    frames: Vec<i64>,
    /// In (0, 1].
    familiarity: f64,
    /// Metres, one entry per step; empty for a single forecast.
    #[serde(default)]
    spread: Vec<f64>,
    hypotheses: Vec<Hypothesis>,
}

#[derive(Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
struct Hypothesis {
    weight: f64,
    goal: Position,
    positions: Vec<Position>,
    #[serde(default)]
    certificate: Value,
}

fn table<T: serde::de::DeserializeOwned>(text: &str) -> Vec<T> {
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    reader.deserialize().collect::<Result<_, _>>().unwrap()
}

/// Compares the certificate of a hypothesis with the positions printed beside it, and returns the distances to the goal
/// after each step.
fn check_certificate(start: Position, hypothesis: &Hypothesis) -> Vec<f64> {
    let value = &hypothesis.certificate;
    let certificate: LyapunovCertificate<f64> = serde_json::from_value(value.clone()).unwrap();
    assert_eq!(certificate.verify(), Ok(()));
    assert_eq!(
        (&value["holds"], &value["violation"]),
        (&Value::Bool(true), &Value::Null)
    );
    assert_eq!(certificate.goal(), hypothesis.goal);
    assert_eq!(certificate.steps().len(), FRAMES);
    assert!(certificate.min_eigenvalue().unwrap() > 0.0);
    for (name, number) in [
        ("min_eigenvalue", certificate.min_eigenvalue()),
        ("min_step_margin", certificate.min_step_margin()),
        ("largest_angle", Some(certificate.largest_angle())),
    ] {
        assert_eq!(value[name].as_f64(), number, "{name}");
    }
    let path = std::iter::once(&start).chain(&hypothesis.positions);
    let left: Vec<f64> = path.map(|&p| distance(p, hypothesis.goal)).collect();
    let potentials: Vec<f64> = certificate.potentials().collect();
    assert_eq!(potentials.len(), left.len());
    let mut pairs = left.iter().zip(&potentials);
    assert!(pairs.all(|(left, potential)| (left - potential).abs() < 1e-12));
    let mut steps = potentials.windows(2);
    assert!(
        steps.all(|step| step[1] < step[0] || step == [0.0, 0.0]),
        "{potentials:?}"
    );
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

#[test]
fn every_format_has_the_same_hypotheses_and_certificates() {
    let place = Place::with_model();
    let tracks = own_tracks::three_pedestrians(10);
    let position_at = |moment, id| {
        let row = tracks.iter().find(|row| (row.0, row.1) == (moment, id));
        row.map(|&(.., x, y)| [x, y]).unwrap()
    };
    let forecast = |options: &str| place.forecast(&tracks, options).succeeds();
    let lines: Vec<JsonLine> = json_lines(&forecast("--format jsonl --certificate"));
    let certified = forecast("--certificate");
    let mut rows = table::<CsvRow>(&certified).into_iter();
    let pedestrians: Vec<_> = lines
        .iter()
        .map(|line| (line.observed_until, line.pedestrian))
        .collect();
    let expected = [70, 80, 90].map(|moment| [1, 2, 3].map(|id| (moment, id)));
    assert_eq!(pedestrians, expected.concat());
    for line in &lines {
        let frames: Vec<i64> = (1..=12).map(|t| line.observed_until + t * FRAME_STEP).collect();
        assert_eq!(line.frames, frames);
        assert_eq!(line.hypotheses.len(), HYPOTHESES);
        let weights: f64 = line.hypotheses.iter().map(|hypothesis| hypothesis.weight).sum();
        assert!((weights - 1.0).abs() < 1e-9);
        assert!(line.familiarity > 0.0 && line.familiarity <= 1.0);
        assert!(line.spread.is_sorted() && line.spread.len() == FRAMES);
        for (k, hypothesis) in line.hypotheses.iter().enumerate() {
            let left = check_certificate(position_at(line.observed_until, line.pedestrian), hypothesis);
            for (t, &position) in hypothesis.positions.iter().enumerate() {
                let row = rows.next().unwrap();
                let place = (row.observed_until, row.pedestrian, row.hypothesis, row.frame);
                assert_eq!(place, (line.observed_until, line.pedestrian, k, frames[t]));
                assert!(own_tracks::alike_in_a_table([row.x, row.y], position));
                let goal = [row.goal_x, row.goal_y];
                assert!(own_tracks::alike_in_a_table(goal, hypothesis.goal));
                assert_eq!(row.weight.to_bits(), hypothesis.weight.to_bits());
                // Rounded to three digits.
                assert!((row.familiarity / line.familiarity - 1.0).abs() < 6e-3);
                assert_eq!([row.unseen, line.unseen], [0; 2]);
                let estimated = [row.age, row.uncertainty, line.age, line.uncertainty];
                assert!(estimated.iter().all(|&number| number == 0.0), "{estimated:?}");
                assert_eq!((row.distance_to_goal, row.certified), (Some(left[t]), Some(true)));
            }
        }
    }
    assert!(rows.next().is_none());
    // The certificate changes no other number.
    let cut = |line: &str| line.split(',').take(13).collect::<Vec<_>>().join(",");
    let cut: Vec<String> = certified.lines().map(cut).collect();
    assert_eq!(forecast("").lines().collect::<Vec<_>>(), cut);
    let header = ",x,y,unseen,age,uncertainty,familiarity,distance_to_goal,certified";
    assert!(certified.lines().next().unwrap().ends_with(header));
    let mut plain: Vec<JsonLine> = json_lines(&forecast("--format jsonl"));
    for (plain, line) in plain.iter_mut().zip(&lines) {
        for (plain, hypothesis) in plain.hypotheses.iter_mut().zip(&line.hypotheses) {
            plain.certificate = hypothesis.certificate.clone();
        }
    }
    assert_eq!(plain, lines);
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
        let forecast = |rows| -> Vec<CsvRow> { table(&place.forecast(rows, "--certificate").succeeds()) };
        let there = forecast(&moved);
        assert_eq!(there.len(), 3 * HYPOTHESES * FRAMES);
        for (here, there) in forecast(&rows).iter().zip(&there) {
            let off = (here.x + east - there.x).hypot(here.y + north - there.y);
            assert!(off < 1e-3, "{variant}: off by {off} m");
        }
        for hypothesis in there.chunks_exact(FRAMES) {
            assert!(hypothesis.iter().all(|row| row.certified == Some(true)));
            let left: Vec<f64> = hypothesis.iter().filter_map(|row| row.distance_to_goal).collect();
            assert!(
                left.windows(2).all(|pair| pair[1] < pair[0] || pair[0] == 0.0),
                "{left:?}"
            );
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
    let refused = place.run("forecast --model run tracks.csv --region 1.5");
    assert!(
        refused.stderr.contains("the probability of a region must be"),
        "{refused:?}"
    );
}
