//! The leak test on reported numbers. Scores of a forecast that do not use the truth (its goals, its collisions) must
//! not depend on the true futures under `fair` and `single`; under `published` they do.

use super::leak::with_future;
use ddl::Variant;
use ddl::data::{Convention, Dataset, Position, WindowRule};
use ddl_tests::own_tracks::Row;
use ddl_tests::place::Place;
use ddl_tests::{crowd, drawn_model};
use serde_json::Value;

/// The convention whose windows of 20 frames are independent: one window is the whole test scene.
const CONVENTION: Convention = Convention::SocialGan;
const TEST_SCENE: &str = "hotel";
const TEST_FILE: &str = "biwi_hotel.txt";

/// Writes simulated pedestrians to the files of the convention. The test scene is one window, in which `future` places
/// all pedestrians after the observation.
fn write_recordings(place: &Place, folder: &str, future: fn(usize, usize, Position) -> Position) {
    let dataset = crowd::dataset();
    let mut scenes = dataset.recordings().iter().cycle();
    let window = with_future(&crowd::windows(1, 8)[0], future);
    for file in CONVENTION.file_names() {
        let rows: Vec<Row> = if file == TEST_FILE {
            let track = |i: usize| window.track(i).iter().enumerate();
            let row = |i, (t, &[x, y]): (usize, &Position)| (10 * t as i64, i as i64, x, y);
            let pedestrians = 0..window.len();
            pedestrians
                .flat_map(|i| track(i).map(move |seen| row(i, seen)))
                .collect()
        } else {
            let seen = scenes.next().unwrap().observations().iter().take(3000);
            seen.map(|o| (o.frame, o.pedestrian.0, o.position[0], o.position[1]))
                .collect()
        };
        let line = |(f, p, x, y): &Row| format!("{f}\t{p}\t{x}\t{y}\n");
        let text: String = rows.iter().map(line).collect();
        place.write(&format!("{folder}/{file}"), text);
    }
}

#[test]
fn reported_numbers_of_a_forecast_do_not_depend_on_the_future() {
    let place = Place::empty();
    write_recordings(&place, "true", |_, _, p| p);
    write_recordings(&place, "changed", |i, t, p| {
        [4.0 + p[1] + i as f64, p[0] - 0.7 * t as f64]
    });
    let mut config = drawn_model::config(Variant::Full);
    config.data.convention = CONVENTION;
    config.data.fold = TEST_SCENE.to_owned();
    config.data.window_rule = WindowRule::SocialGan { min_pedestrians: 1 };
    let dataset = Dataset::load(CONVENTION, &place.at("true")).unwrap();
    let windows = dataset.fold(TEST_SCENE).unwrap();
    let windows = windows.training_windows(config.data.window_rule);
    drawn_model::write(config, &windows, &place.at("run"));
    let [before, after] = ["true", "changed"].map(|data| {
        let protocols = "--protocol published --protocol fair --protocol single";
        let line = format!("evaluate --model run --data {data} {protocols} --out {data}-report");
        place.json(&format!("{line} --threads 1 --json"))["rows"].take()
    });
    let [before, after] = [before, after].map(|rows| match rows {
        Value::Array(rows) => rows,
        other => panic!("{other}"),
    });
    assert!(!before.is_empty() && before.len() == after.len());
    let mut published_changes = 0;
    for (before, after) in before.iter().zip(&after) {
        let conditions = &before["conditions"];
        assert_eq!(conditions, &after["conditions"]);
        let changed = |score: &str| before["scores"][score] != after["scores"][score];
        assert!(changed("min_ade"), "the futures were not changed: {conditions}");
        // Scores of a forecast that do not use the truth.
        let depends = changed("collision_rate") || changed("stability");
        if conditions["protocol"] == "published" {
            published_changes += usize::from(depends);
        } else {
            assert!(!depends, "{before:#} became {after:#}");
        }
    }
    assert!(published_changes > 0, "the published goals know the future");
}
