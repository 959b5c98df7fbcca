//! `ddl forecast --certificate`: every hypothesis carries the evidence that it goes to its goal, and the
//! evidence is about the positions printed.

use ddl::data::{OBSERVED, Position, Window};
use ddl::dynamics::LyapunovCertificate;
use ddl::network::weights::load_weights;
use ddl::network::{ForecastWindows as _, MotionNetwork, Noise, StepRule};
use ddl::{Calibration, CertificateError, Forecaster as _, Variant};
use ddl_tests::own_tracks::{self, Row};
use ddl_tests::{bits, crowd, program, tiny_model};
use serde::Deserialize;

const FRAMES: usize = 12;
const HYPOTHESES: usize = 20;

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
    distance_to_goal: f64,
    certified: bool,
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
    /// In (0, 1]; metres, one a step.
    familiarity: f64,
    spread: Vec<f64>,
    hypotheses: Vec<Hypothesis>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Hypothesis {
    weight: f64,
    goal: [f64; 2],
    positions: Vec<[f64; 2]>,
    certificate: serde_json::Value,
}

fn json_lines(text: &str) -> Vec<JsonLine> {
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

fn distance(a: Position, b: Position) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// The certificate of a hypothesis, held against the positions printed beside it.
fn check(start: Position, hypothesis: &Hypothesis) -> LyapunovCertificate<f64> {
    let value = &hypothesis.certificate;
    let certificate: LyapunovCertificate<f64> = serde_json::from_value(value.clone()).unwrap();
    assert_eq!(certificate.holds(), Ok(()));
    assert_eq!(value["holds"], true);
    assert!(value["violation"].is_null());
    assert_eq!(certificate.goal(), hypothesis.goal);
    assert_eq!(certificate.steps().len(), FRAMES);
    assert_eq!(
        value["min_eigenvalue"].as_f64(),
        certificate.min_eigenvalue()
    );
    assert!(certificate.min_eigenvalue().unwrap() > 0.0);
    assert_eq!(
        value["min_step_margin"].as_f64(),
        certificate.min_step_margin()
    );
    assert_eq!(
        value["largest_angle"].as_f64(),
        Some(certificate.largest_angle())
    );
    let path = std::iter::once(&start).chain(&hypothesis.positions);
    let potentials: Vec<f64> = certificate.potentials().collect();
    assert_eq!(potentials.len(), FRAMES + 1);
    for (position, potential) in path.zip(&potentials) {
        let left = distance(*position, hypothesis.goal);
        assert!(
            (left - potential).abs() < 1e-12,
            "{left} m, not {potential} m"
        );
    }
    for step in potentials.windows(2) {
        assert!(
            step[1] < step[0] || (step[0] == 0.0 && step[1] == 0.0),
            "{step:?}"
        );
    }
    certificate
}

#[test]
fn every_certificate_holds_and_speaks_of_the_positions_printed() {
    let folder = tiny_model::folder(Variant::Full);
    let rows = own_tracks::three_people(10);
    let at = |frame, pedestrian| {
        let row = rows
            .iter()
            .find(|row| (row.0, row.1) == (frame, pedestrian));
        row.map(|&(_, _, x, y)| [x, y]).unwrap()
    };
    let json = program::forecast(folder.path(), &rows, "--format jsonl --certificate").succeeds();
    let lines = json_lines(&json);
    let table = program::forecast(folder.path(), &rows, "--certificate").succeeds();
    let mut printed = csv_rows(&table).into_iter();
    assert_eq!(lines.len(), 9);
    for line in &lines {
        assert_eq!(line.hypotheses.len(), HYPOTHESES);
        for (k, hypothesis) in line.hypotheses.iter().enumerate() {
            let start = at(line.observed_until, line.pedestrian);
            let certificate = check(start, hypothesis);
            let left = certificate.potentials().skip(1);
            for ((position, &frame), left) in
                hypothesis.positions.iter().zip(&line.frames).zip(left)
            {
                let row = printed.next().unwrap();
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
                assert_eq!(row.weight.to_bits(), hypothesis.weight.to_bits());
                let goal = [row.goal_x, row.goal_y];
                assert!(own_tracks::alike_in_a_table(goal, hypothesis.goal));
                // to three digits
                assert!((row.familiarity / line.familiarity - 1.0).abs() < 6e-3);
                assert!(line.familiarity > 0.0 && line.spread.len() == FRAMES);
                let made_up = [row.padded, row.filled, line.padded, line.filled];
                assert_eq!(made_up, [0; 4]);
                assert_eq!(row.distance_to_goal.to_bits(), left.to_bits());
                assert!(row.certified);
            }
        }
    }
    assert!(printed.next().is_none());
}

/// Far from the origin numbers are coarse: in map coordinates they lie 1e-9 m apart.
#[test]
fn certificates_hold_in_map_coordinates() {
    let folder = tiny_model::folder(Variant::NoGoalShift);
    let moved: Vec<Row> = own_tracks::three_people(8)
        .iter()
        .map(|&(frame, id, x, y)| (frame, id, x + 500_000.0, y + 4_600_000.0))
        .collect();
    let table = program::forecast(folder.path(), &moved, "--certificate").succeeds();
    let rows = csv_rows(&table);
    assert_eq!(rows.len(), 3 * HYPOTHESES * FRAMES);
    assert!(rows.iter().all(|row| row.certified));
    for hypothesis in rows.chunks_exact(FRAMES) {
        let falls = hypothesis.windows(2).all(|pair| {
            pair[1].distance_to_goal < pair[0].distance_to_goal || pair[0].distance_to_goal == 0.0
        });
        assert!(falls, "{hypothesis:?}");
    }
}

#[test]
fn the_certificate_changes_no_other_number() {
    let folder = tiny_model::folder(Variant::Full);
    let rows = own_tracks::three_people(9);
    let plain = program::forecast(folder.path(), &rows, "").succeeds();
    let certified = program::forecast(folder.path(), &rows, "--certificate").succeeds();
    let cut: Vec<String> = certified
        .lines()
        .map(|line| line.split(',').take(12).collect::<Vec<_>>().join(","))
        .collect();
    assert_eq!(plain.lines().collect::<Vec<_>>(), cut);
    let header = certified.lines().next().unwrap();
    assert!(
        header.ends_with(",x,y,padded,filled,familiarity,distance_to_goal,certified"),
        "{header}"
    );
}

#[test]
fn a_variant_without_dynamics_has_nothing_to_certify() {
    let rows = own_tracks::three_people(8);
    for variant in [Variant::Star, Variant::NoDynamics] {
        let folder = tiny_model::folder(variant);
        let message = program::forecast(folder.path(), &rows, "--certificate").fails();
        let name = format!("`{variant}`");
        assert!(
            message.contains(&name) && message.contains("no flow to certify"),
            "{message}"
        );
    }
}

/// The forecast is the reference implementation's walk; the tensors walk the same way, up to `f32`.
#[test]
fn the_walk_agrees_with_the_tensors() {
    let windows = crowd::windows(6, 24);
    for variant in [Variant::Full, Variant::NoGoalShift] {
        let tiny = tiny_model::of(variant);
        let config = tiny.model.config().star.clone();
        let network = MotionNetwork::new(config, 0).unwrap();
        let origin = tiny.model.config().network_origin();
        let file = tiny.model.run().unwrap().model();
        let weights = load_weights(network.weights().layout(), &origin, &file).unwrap();
        let network = network.with_weights(weights).unwrap();
        let certified = tiny.model.forecast_certified(&windows).unwrap();
        let goals: Vec<Vec<Vec<Position>>> = windows
            .iter()
            .zip(&certified)
            .map(|(window, certified)| {
                let goal = |i, k| certified.forecast.goal(i, k).unwrap();
                let of_walker = |i| (0..HYPOTHESES).map(|k| goal(i, k)).collect();
                (0..window.len()).map(of_walker).collect()
            })
            .collect();
        let trusted = |window: &Window| {
            let familiarity = tiny.model.goal_model().familiarity(window);
            let share =
                |&f: &f64| Calibration::fitted().share * f / (f + Calibration::fitted().half_trust);
            familiarity.iter().map(share).collect()
        };
        let shares: Vec<Vec<f64>> = windows.iter().map(trusted).collect();
        let rollouts = network
            .forecast_windows(
                &windows,
                &goals,
                Noise::Expected,
                StepRule::Bounded,
                Some(&shares),
            )
            .unwrap();
        let mut largest = 0.0_f64;
        for (certified, rollout) in certified.iter().zip(rollouts) {
            let mut paths = rollout.positions.chunks_exact(FRAMES);
            let forecast = &certified.forecast;
            for (i, k) in
                (0..forecast.pedestrians()).flat_map(|i| (0..HYPOTHESES).map(move |k| (i, k)))
            {
                assert_eq!(forecast.certified(i, k), Some(true));
                let path = paths.next().unwrap();
                for (&ours, &tensor) in forecast.hypothesis(i, k).iter().zip(path) {
                    largest = largest.max(distance(ours, tensor));
                }
            }
        }
        // 3e-6 m and 4e-6 m as measured
        assert!(largest < 1e-4, "{variant}: {largest} m apart");
    }
}

#[test]
fn the_certified_forecast_is_the_forecast() {
    let windows = crowd::windows(3, 10);
    let tiny = tiny_model::of(Variant::Full);
    let certified = tiny.model.forecast_certified(&windows).unwrap();
    let plain = tiny.model.forecast_all(&windows).unwrap();
    for ((certified, plain), window) in certified.iter().zip(&plain).zip(&windows) {
        assert_eq!(bits::of(&certified.forecast), bits::of(plain));
        assert_eq!(certified.first_violation(), None);
        assert_eq!(certified.certificates.len(), window.len() * HYPOTHESES);
        for i in 0..window.len() {
            let first = certified.certificate(i, 3).potentials().next().unwrap();
            let goal = plain.goal(i, 3).unwrap();
            let start = window.observed(i)[OBSERVED - 1];
            assert!((first - distance(start, goal)).abs() < 1e-12);
        }
    }
}

/// The walk to the central goal has the same guarantee, comes nearer to that goal at every step, and ends there.
#[test]
fn the_one_forecast_is_certified_towards_the_central_goal() {
    let windows = crowd::windows(6, 24);
    for variant in [Variant::Full, Variant::NoGoalShift, Variant::NoDynamics] {
        let tiny = tiny_model::of(variant);
        let goals = tiny.model.goal_model().goals(&windows).unwrap();
        let forecasts = tiny.model.forecast_one(&windows).unwrap();
        assert_eq!(forecasts.len(), windows.len());
        for ((forecast, sets), window) in forecasts.iter().zip(&goals).zip(&windows) {
            assert_eq!(
                (forecast.pedestrians(), forecast.hypotheses()),
                (window.len(), 1)
            );
            for (i, set) in sets.iter().enumerate() {
                assert_eq!(forecast.certified(i, 0), Some(true), "{variant}");
                assert_eq!(forecast.weight(i, 0).to_bits(), 1.0_f64.to_bits());
                let goal = forecast.goal(i, 0).unwrap();
                assert_eq!(
                    goal.map(f64::to_bits),
                    set.central(window.observed(i)).map(f64::to_bits)
                );
                let start = window.observed(i)[OBSERVED - 1];
                let path = std::iter::once(&start).chain(forecast.hypothesis(i, 0));
                let left: Vec<f64> = path.map(|&position| distance(position, goal)).collect();
                assert_eq!(left.len(), FRAMES + 1);
                let falls = left
                    .windows(2)
                    .all(|pair| pair[1] < pair[0] || pair[0] == 0.0);
                assert!(falls, "{variant}: {left:?}");
                assert!(left[FRAMES] < 1e-9, "{variant}: {left:?}");
            }
        }
    }
}

#[test]
fn the_facade_says_why_it_has_no_certificate() {
    let tiny = tiny_model::of(Variant::NoDynamics);
    let error = tiny
        .model
        .forecast_certified(&crowd::windows(1, 2))
        .unwrap_err();
    let ddl::eval::ForecastError::Model { source, .. } = error else {
        panic!("{error}")
    };
    assert_eq!(
        source.downcast_ref::<CertificateError>(),
        Some(&CertificateError::NoFlow {
            variant: Variant::NoDynamics
        })
    );
}
