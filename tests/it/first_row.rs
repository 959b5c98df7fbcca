//! People seen for the first time: each is forecast from its first row on, and changes no forecast of others.

use ddl::data::{Completeness, HORIZON, LiveTracks, OBSERVED, PedestrianId, Position};
use ddl::{BuiltinModel, Ddl, DeviceChoice, Request};
use ddl_core::distance;
use ddl_tests::bits;
use ddl_tests::own_tracks::{self, Row};
use ddl_tests::place::{Place, json_lines};
use proptest::prelude::*;
use serde_json::Value;
use std::sync::LazyLock;

static MODELS: LazyLock<[Ddl; BuiltinModel::ALL.len()]> =
    LazyLock::new(|| BuiltinModel::ALL.map(|model| Ddl::builtin(model, DeviceChoice::Cpu).unwrap()));

/// Somebody at (1, 0) at the last frame, alone and with two who walk 10 m away.
fn scenes() -> [Vec<Row>; 2] {
    let first = (29, 1, 1.0, 0.0);
    let walk = |frame: i64| [(frame, 7, 8.0 + 0.13 * frame as f64, 6.0), (frame, 8, 13.0, -3.0 - 0.1 * frame as f64)];
    [vec![first], (0..30).flat_map(walk).chain([first]).collect()]
}

/// A robot that sees somebody for the first time, 1 m ahead on its plan: files and streams, seen or not.
#[test]
fn whoever_appears_on_the_plan_is_a_risk() {
    let place = Place::empty();
    place.write("plan.csv", "t,x,y\n0,0,0\n4.8,4,0\n");
    for rows in scenes() {
        place.write_tracks("tracks.csv", &rows);
        for seen in ["", "--unseen"] {
            let options = format!("--fps 10 --plan plan.csv --format jsonl {seen}");
            let of_file = place.ok(&format!("risk tracks.csv --last {options}"));
            let of_stream = place.run_on(&own_tracks::csv(&rows), &format!("risk - {options}")).succeeds();
            let risk: Value = json_lines(&of_file).pop().unwrap();
            assert_eq!(json_lines::<Value>(&of_stream).pop().unwrap(), risk);
            assert!(risk["risk"].as_f64().unwrap() > 0.5, "{risk}");
        }
        let forecast = "--fps 10 --format jsonl";
        let line = |lines: &str| json_lines::<Value>(lines).into_iter().rfind(|line| line["pedestrian"] == 1).unwrap();
        let of_file = line(&place.ok(&format!("forecast tracks.csv --last {forecast}")));
        let of_stream = place.run_on(&own_tracks::csv(&rows), &format!("forecast - {forecast}")).succeeds();
        assert_eq!((line(&of_stream), &of_file["unseen"]), (of_file.clone(), &7.into()));
        assert_eq!(of_file["familiarity"], 1.0);
        // Its cells now, and those around it in 1.2 s.
        let grids = place.ok("occupancy tracks.csv --fps 10 --last --every 1.2 --cell 0.25 --area=-1,-2,3,2");
        let grids = json_lines::<Value>(&grids).into_iter();
        let sums = grids.map(|grid| grid["data"].as_array().unwrap().iter().filter_map(Value::as_f64).sum::<f64>());
        let [now, soon, ..] = sums.collect::<Vec<f64>>()[..] else { panic!() };
        assert!(now >= 100.0 && soon > 50.0, "{now} {soon}");
    }
    let told = place.run("forecast tracks.csv --fps 10 --last").says("of 3 forecasts 1 are of pedestrians tracked for");
    assert!(told.stderr.contains("(1 of them just seen, so that nobody knows where they go)"), "{told:?}");
    assert_eq!(place.ok("forecast tracks.csv --fps 10 --last --whole --one").lines().count(), 1 + 2 * HORIZON);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    /// Others keep every bit of their forecasts, wherever somebody appears. Who appears is forecast in any direction,
    /// within reach and with certificates, and stays at the place in the one forecast.
    #[test]
    fn whoever_appears_changes_nobody(
        walks in prop::collection::vec(prop::array::uniform4(-1.6..1.6), 1..5),
        at in prop::array::uniform2(-9.0..9.0),
        later in 0..2_usize,
    ) {
        let mut tracks = LiveTracks::new().with_completeness(Completeness::Partial);
        let place = |[x, y, u, v]: [f64; 4], frame: i64| {
            let time = 0.4 * frame as f64;
            [4.0 * x + time * u, 4.0 * y + time * v]
        };
        let rows = |frame| (2..).map(PedestrianId).zip(walks.iter().map(move |walk| place(*walk, frame)));
        let last = 7 + later as i64;
        for frame in 0..last {
            tracks.push(frame, rows(frame)).unwrap();
        }
        let without = tracks.after(last, rows(last)).unwrap().window().unwrap();
        let with = tracks.after(last, rows(last).chain([(PedestrianId(1), at)])).unwrap().window().unwrap();
        let others: Vec<usize> = (1..with.len()).collect();
        for model in &*MODELS {
            let [before, after] = [&without, &with].map(|window| {
                let request = Request::default().with_certificates();
                model.forecast(std::slice::from_ref(window), &request).unwrap().remove(0)
            });
            let kept = after.forecast().of_pedestrians(&others);
            prop_assert_eq!(bits::of_all(&[kept]), bits::of_all(&[before.into_forecast()]), "{}", model.source());
            prop_assert_eq!(after.first_violation(), None);
            let goals: Vec<Position> = (0..20).map(|k| after.forecast().goal(0, k).unwrap()).collect();
            prop_assert!(goals.iter().all(|goal| distance(*goal, at) < 4.8 * 2.15));
            let mean = goals.iter().zip(0..).map(|(goal, k)| after.forecast().weight(0, k) * (goal[0] - at[0]));
            prop_assert!(mean.sum::<f64>().abs() < 0.3 && goals.iter().any(|goal| distance(*goal, at) < 0.7));
            let one = model.forecast(std::slice::from_ref(&with), &Request::one()).unwrap();
            prop_assert!(distance(one[0].forecast().hypothesis(0, 0)[HORIZON - 1], at) < 0.5);
        }
        prop_assert_eq!(with.observed(0), [at; OBSERVED]);
    }
}
