//! Window counts of the real recordings, against numbers computed outside this project.

use ddl_data::{Convention, Dataset, NEIGHBOUR_HALF_WIDTH, OBSERVED, Window, WindowRule};
use serde_json::Value;

use crate::recordings;

fn reference() -> Value {
    serde_json::from_str(include_str!("reference/window_counts.json")).unwrap()
}

/// Number of windows, and of pedestrians summed over them.
fn count(windows: &[Window]) -> (u64, u64) {
    (
        windows.len() as u64,
        windows.iter().map(Window::len).sum::<usize>() as u64,
    )
}

fn expected(counts: &Value, windows: &str, pedestrians: &str) -> (u64, u64) {
    (
        counts[windows].as_u64().unwrap(),
        counts[pedestrians].as_u64().unwrap(),
    )
}

fn names(list: &Value) -> Vec<&str> {
    list.as_array()
        .unwrap()
        .iter()
        .map(|name| name.as_str().unwrap())
        .collect()
}

#[test]
fn each_star_recording_has_the_windows_of_the_reference() {
    let Some(dataset) = recordings::load(Convention::Star) else {
        return;
    };
    let reference = reference();
    let all = reference["recordings"].as_object().unwrap();
    assert_eq!(all.len(), dataset.recordings().len());
    for (name, counts) in all {
        let recording = dataset.recording(name).unwrap();
        assert_eq!(
            recording.frames().len() as u64,
            counts["frames"].as_u64().unwrap(),
            "{name}"
        );
        assert_eq!(
            recording.frames()[0],
            counts["first_frame"].as_i64().unwrap(),
            "{name}"
        );
        for (rule, word) in [
            (WindowRule::Published, "published"),
            (WindowRule::Complete, "complete"),
        ] {
            let windows = format!("{word}_windows");
            let pedestrians = format!("{word}_pedestrian_windows");
            assert_eq!(
                count(&recording.windows(rule)),
                expected(counts, &windows, &pedestrians),
                "{name}, {rule}"
            );
        }
    }
}

#[test]
fn each_star_fold_has_the_windows_of_the_reference() {
    let Some(dataset) = recordings::load(Convention::Star) else {
        return;
    };
    let reference = reference();
    let all = reference["folds"].as_object().unwrap();
    assert_eq!(all.len(), dataset.fold_names().len());
    for (name, counts) in all {
        let fold = dataset.fold(name).unwrap();
        let recordings: Vec<_> = fold.test_recordings().iter().map(|r| r.name()).collect();
        assert_eq!(recordings, names(&counts["test_recordings"]), "{name}");
        let recordings: Vec<_> = fold
            .training_recordings()
            .iter()
            .map(|r| r.name())
            .collect();
        assert_eq!(recordings, names(&counts["train_recordings"]), "{name}");

        let published = fold.test_windows(WindowRule::Published);
        let pairs: usize = published
            .iter()
            .map(|w| {
                w.neighbours(OBSERVED - 1, NEIGHBOUR_HALF_WIDTH)
                    .pairs()
                    .count()
            })
            .sum();
        assert_eq!(
            pairs as u64,
            counts["published_test"]["neighbour_pairs_at_last_observed_frame"]
                .as_u64()
                .unwrap(),
            "{name}"
        );
        for (part, windows) in [
            ("published_test", published),
            ("complete_test", fold.test_windows(WindowRule::Complete)),
            (
                "complete_train",
                fold.training_windows(WindowRule::Complete),
            ),
            (
                "published_rule_train_before_drop_and_duplicates",
                fold.training_windows(WindowRule::Published),
            ),
        ] {
            let counts = expected(&counts[part], "windows", "pedestrian_windows");
            assert_eq!(count(&windows), counts, "{name}, {part}");
        }
    }
}

#[test]
fn each_social_gan_fold_has_the_windows_of_the_reference() {
    let Some(dataset) = recordings::load(Convention::SocialGan) else {
        return;
    };
    let reference = reference();
    let all = &reference["social_gan_test_windows_and_pedestrians"];
    for (part, min_pedestrians) in [("min_1_pedestrian", 1), ("min_2_pedestrians", 2)] {
        assert_eq!(
            all[part].as_object().unwrap().len(),
            dataset.fold_names().len()
        );
        for fold in dataset.folds() {
            let counts = &all[part][fold.name()];
            assert_eq!(
                count(&fold.test_windows(WindowRule::SocialGan { min_pedestrians })),
                (counts[0].as_u64().unwrap(), counts[1].as_u64().unwrap()),
                "{}, {part}",
                fold.name()
            );
        }
    }
}

/// The first row of each file, looked up by hand: the coordinates are not swapped, or swapped, as
/// the convention has it, and both conventions agree where they hold the same recording.
#[test]
fn coordinates_are_read_the_right_way_round() {
    let first = |dataset: &Dataset, name: &str| dataset.recording(name).unwrap().observations()[0];
    let Some(star) = recordings::load(Convention::Star) else {
        return;
    };
    let eth = first(&star, "eth");
    assert_eq!(
        (eth.frame, eth.pedestrian.0, eth.position),
        (780, 1, [3.5881, 8.4568])
    );
    let Some(social_gan) = recordings::load(Convention::SocialGan) else {
        return;
    };
    let eth = first(&social_gan, "eth");
    assert_eq!(
        (eth.frame, eth.pedestrian.0, eth.position),
        (780, 1, [8.46, 3.59])
    );
    for name in ["students001", "students003"] {
        let (a, b) = (
            star.recording(name).unwrap(),
            social_gan.recording(name).unwrap(),
        );
        assert_eq!(a.observations().len(), b.observations().len());
        for (a, b) in a.observations().iter().zip(b.observations()) {
            assert_eq!((a.frame, a.pedestrian), (b.frame, b.pedestrian));
            for (a, b) in a.position.iter().zip([b.position[1], b.position[0]]) {
                assert!((a - b).abs() < 1e-3, "{name}: {a} and {b}");
            }
        }
    }
}
