//! Window counts of the real recordings, against numbers computed outside this project.

use ddl_core::{OBSERVED, SpatialIndex, Window};
use ddl_data::{Convention, Recording, WindowRule};
use serde_json::{Map, Value};

use crate::recordings;

fn reference(part: &str) -> Map<String, Value> {
    let counts: Value = serde_json::from_str(include_str!("reference/window_counts.json")).unwrap();
    counts[part].as_object().unwrap().clone()
}

fn count(windows: &[Window]) -> [i64; 2] {
    [windows.len(), windows.iter().map(Window::len).sum()].map(|count| count as i64)
}

fn expected<const N: usize>(counts: &Value, names: [&str; N]) -> [i64; N] {
    names.map(|name| counts[name].as_i64().unwrap())
}

#[test]
fn each_star_recording_has_the_windows_of_the_reference() {
    let Some(dataset) = recordings::load(Convention::Star) else { return };
    let counts = reference("recordings");
    assert_eq!(counts.len(), dataset.recordings().len());
    for (name, counts) in &counts {
        let recording = dataset.recording(name).unwrap();
        let frames = recording.frames();
        let actual = [frames.len() as i64, frames[0]];
        assert_eq!(actual, expected(counts, ["frames", "first_frame"]), "{name}");
        for (rule, names) in [
            (WindowRule::Published, ["published_windows", "published_pedestrian_windows"]),
            (WindowRule::Complete, ["complete_windows", "complete_pedestrian_windows"]),
        ] {
            assert_eq!(count(&recording.windows(rule)), expected(counts, names), "{name}, {rule}");
        }
    }
}

#[test]
fn each_star_fold_has_the_windows_of_the_reference() {
    let Some(dataset) = recordings::load(Convention::Star) else { return };
    let counts = reference("folds");
    assert_eq!(counts.len(), dataset.fold_names().len());
    for (name, counts) in &counts {
        let fold = dataset.fold(name).unwrap();
        for (part, recordings) in
            [("test_recordings", fold.test_recordings()), ("train_recordings", fold.training_recordings())]
        {
            let names: Vec<&str> = recordings.iter().copied().map(Recording::name).collect();
            assert_eq!(serde_json::json!(names), counts[part], "{name}");
        }
        let published = fold.test_windows(WindowRule::Published);
        // Without the pedestrians themselves.
        let pairs = |w: &Window| -> usize {
            let places = w.positions_at(OBSERVED - 1);
            let index = SpatialIndex::new(&places);
            places.iter().map(|&place| index.within_box(place, 10.0).count() - 1).sum()
        };
        let pairs: usize = published.iter().map(pairs).sum();
        let names = ["neighbour_pairs_at_last_observed_frame"];
        assert_eq!([pairs as i64], expected(&counts["published_test"], names), "{name}");
        let training = |rule| fold.training_windows(rule);
        for (part, windows) in [
            ("published_test", published),
            ("complete_test", fold.test_windows(WindowRule::Complete)),
            ("complete_train", training(WindowRule::Complete)),
            ("published_rule_train_before_drop_and_duplicates", training(WindowRule::Published)),
        ] {
            let counts = expected(&counts[part], ["windows", "pedestrian_windows"]);
            assert_eq!(count(&windows), counts, "{name}, {part}");
        }
    }
}

#[test]
fn each_social_gan_fold_has_the_windows_of_the_reference() {
    let Some(dataset) = recordings::load(Convention::SocialGan) else { return };
    let counts = reference("social_gan_test_windows_and_pedestrians");
    for (part, min_pedestrians) in [("min_1_pedestrian", 1), ("min_2_pedestrians", 2)] {
        let rule = WindowRule::SocialGan { min_pedestrians };
        let folds = dataset.folds().into_iter();
        let actual: Map<String, Value> =
            folds.map(|fold| (fold.name().to_owned(), count(&fold.test_windows(rule)).to_vec().into())).collect();
        assert_eq!(Value::from(actual), counts[part], "{part}");
    }
}

/// The first row of each file, looked up by hand: x and y are swapped where the convention swaps them, and only there.
#[test]
fn coordinates_are_read_the_right_way_round() {
    for (convention, position) in [(Convention::Star, [3.5881, 8.4568]), (Convention::SocialGan, [8.46, 3.59])] {
        let Some(dataset) = recordings::load(convention) else { return };
        let eth = dataset.recording("eth").unwrap().observations()[0];
        assert_eq!((eth.frame, eth.pedestrian.0, eth.position), (780, 1, position), "{convention}");
    }
}
