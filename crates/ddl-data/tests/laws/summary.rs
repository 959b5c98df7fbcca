//! Summaries of recordings and their plausibility checks.

use ddl_core::{PedestrianId, Position};
use ddl_data::{Format, Observation, PlausibilityWarning, Recording, parse_recording};

/// A pedestrian that walks along x at a speed in metres per frame, for 100 frames.
fn walk(metres_a_frame: f64) -> Vec<Observation> {
    (0..100).map(|t| Observation::new(t, PedestrianId(1), [metres_a_frame * t as f64, 0.0])).collect()
}

fn warnings(seen: Vec<Observation>) -> Vec<PlausibilityWarning> {
    Recording::new("yard", 1, seen).unwrap().summary().warnings()
}

#[test]
fn implausible_speeds_give_warnings() {
    // 1.3 m/s in steps of 0.4 s.
    assert_eq!(warnings(walk(0.52)), []);
    // A standing pedestrian causes no warning, even with the noise of a tracker.
    let stand = |id: i64, t: i64| Observation::new(t, PedestrianId(id), [0.03 * (t * t % 7) as f64, id as f64]);
    assert_eq!(warnings((0..100).map(|t| stand(1, t)).collect()), []);
    // Those who walk among more who stand show a wrong unit too.
    let crowd = (0..100).flat_map(|t| [2, 3].map(|id| stand(id, t)));
    let among = warnings(walk(3.0).into_iter().chain(crowd).collect());
    assert!(among[0].to_string().starts_with("half of the steps of walking pedestrians"), "{among:?}");
}

/// A camera at 25 frames per second whose tracker loses every tenth detection, and with them the positions at whole
/// steps.
#[test]
fn missing_detections_are_reported() {
    let seen: Vec<Observation> = (0..1000)
        .flat_map(|t| [1, 2].map(|id| Observation::new(t, PedestrianId(id), [0.05 * t as f64, id as f64])))
        .filter(|seen| (seen.frame + 5 * seen.pedestrian.0) % 10 != 7)
        .collect();
    let summary = Recording::new("film", 10, seen).unwrap().summary();
    assert!((summary.unseen - 0.1).abs() < 0.002, "{}", summary.unseen);
    let [PlausibilityWarning::Unseen { share }, ..] = summary.warnings()[..] else {
        panic!("{:?}", summary.warnings());
    };
    assert_eq!(share.to_bits(), summary.unseen.to_bits());
    assert_eq!(Recording::new("yard", 1, walk(0.5)).unwrap().summary().unseen.to_bits(), 0.0_f64.to_bits());
}

#[test]
fn a_track_that_jumps_is_reported_with_its_frame() {
    let mut seen = walk(0.5);
    for observation in &mut seen[40..] {
        observation.position[1] += 20.0;
    }
    let warnings = warnings(seen);
    let [PlausibilityWarning::Jump { fastest, .. }] = &warnings[..] else {
        panic!("{warnings:?}");
    };
    assert_eq!((&fastest.pedestrian, fastest.frame), (&PedestrianId(1).into(), 40));
    assert!(warnings[0].to_string().contains("pedestrian 1 jumps in the step that ends at frame 40"));
}

#[test]
fn holes_and_training_samples_are_counted() {
    let mut seen = walk(0.5);
    seen.remove(50);
    let summary = Recording::new("yard", 1, seen).unwrap().summary();
    assert_eq!((summary.holes, summary.pedestrians, summary.frames), (1, 1, 99));
    let gap = summary.longest_hole.unwrap();
    assert_eq!((&gap.pedestrian, gap.after), (&PedestrianId(1).into(), 49));
    assert!((gap.seconds - 0.8).abs() < 1e-12);
    // 20 steps from each of the frames 0 to 80, but no moment at frame 50.
    assert_eq!(summary.to_learn_from, 80);
    let summary = Recording::new("yard", 1, walk(0.5)[..12].to_vec()).unwrap().summary();
    assert_eq!((summary.to_forecast, summary.seen_whole), (12, 5));
    assert_eq!(summary.warnings(), [PlausibilityWarning::NothingToLearnFrom]);
    // Two and four rows of a hundred.
    let without = |missing: usize| warnings([&walk(0.5)[..50], &walk(0.5)[50 + missing..]].concat()).len();
    assert_eq!([without(2), without(4)], [0, 1]);
}

/// A counter and a time of day that wrap, of one and in the order of tracks, and parts of a crowd; but no disorder.
#[test]
fn frames_that_begin_again_are_counted() {
    for (rows, count) in [
        ("98,1 99,1 0,1 1,1", 1),
        ("98,1 99,1 0,1 1,1 2,2 3,2", 1),
        ("0,1 1,1 20,1 0,2 9,2 60,2", 0),
        ("0,1 0,2 9,1 9,2 60,1 60,2 0,3 0,4 60,3 60,4", 1),
        ("3,1 1,2 2,3 6,1 4,2 9,3 7,2", 0),
        ("30,1 9,1 50,1 2,1", 0),
        ("0,1 0,2 4,1 4,2 3,3 3,4 8,3 8,4", 0),
    ] {
        for head in ["frame", "time"] {
            let text = format!("{head},id,x,y\n{},0,0\n", rows.replace(' ', ",0,0\n"));
            let recording = parse_recording(text.as_bytes(), "f", Format::Table).unwrap();
            assert_eq!(recording.summary().restarts, count, "{text}");
        }
    }
}

/// A place so far (m) along a line that is not an axis.
fn on_way(metres: f64) -> Position {
    [0.6 * metres, 5.0 + 0.8 * metres]
}

/// Tracks of so many rows, one every 0.2 s.
fn tracks(rows: i64, places: &[&dyn Fn(f64) -> Position]) -> Recording {
    let of_track = |(id, place): (i64, &&dyn Fn(f64) -> Position)| -> Vec<Observation> {
        (0..rows).map(|t: i64| Observation::new(t, PedestrianId(id), place(t as f64))).collect()
    };
    Recording::new("yard", 2, (1..).zip(places).flat_map(of_track).collect()).unwrap()
}

/// Checks the name of the first warning, if there is one.
fn check(expected: &str, rows: i64, places: &[&dyn Fn(f64) -> Position]) {
    let warning = tracks(rows, places).speed_warning();
    let found = warning.map_or_else(String::new, |warning| format!("{warning:?}"));
    assert_eq!(found.split(' ').next(), Some(expected), "{found}");
}

/// Each limit, from both sides; 59 steps in 61 rows, which are 12 s.
#[test]
fn speeds_are_doubted_from_their_limits_on() {
    // Steady walks, in m/s: 1.92 m are no walk, 2.16 m are.
    for (rows, speed, expected) in [
        (61, 2.55, ""),
        (61, 2.65, "Fast"),
        (61, 0.59, "Slow"),
        (61, 0.61, ""),
        (61, 0.16, ""),
        (61, 0.18, "Slow"),
        (61, 0.095, "Crawling"),
        (61, 0.105, ""),
        (61, 0.0017, "Crawling"),
        (61, 0.0016, "Still"),
        (21, 0.004, ""),
        (22, 0.004, "Still"),
        (40, 0.095, ""),
        (41, 0.095, "Crawling"),
    ] {
        check(expected, rows, &[&|t| on_way(0.2 * speed * t)]);
    }
    // 1.5 m/s for a few rows, two of whose steps are half as fast, and 0.3 m/s otherwise: nine in ten are 53 steps.
    for (quick, expected) in [(4.0, "Slow"), (6.0, "")] {
        check(expected, 61, &[&|t| on_way(0.06 * t + 0.24 * (t - 20.0).clamp(0.0, quick))]);
    }
    // 0.24 m/s now and then is not straight on.
    check("", 61, &[&|t| on_way(0.048 * ((t / 9.0).floor() * 3.0 + (t % 9.0).min(3.0)))]);
    // Beside two who walk in a circle.
    let circle = |t: f64| [2.0 * (0.1 * t).cos(), 2.0 * (0.1 * t).sin()];
    check("", 61, &[&|t| on_way(0.019 * t), &circle, &circle]);
    // With 0.4 m of the step: 11.75 and 12.25 m/s.
    for (jump, expected) in [(4.3, ""), (4.5, "Jump")] {
        check(expected, 61, &[&|t| on_way(0.2 * t + if t < 30.0 { 0.0 } else { jump })]);
    }
}

#[test]
fn places_that_repeat_or_are_near_are_doubted_from_their_limits_on() {
    // Six rows are more than a twentieth of 118 steps, if both have several.
    for (one, other, expected) in [(3.0, 3.0, "Placeholders"), (3.0, 2.0, "Still"), (6.0, 1.0, "Still")] {
        let stand = |place: Position, rows: f64| move |t| if t >= 9.0 && t < 9.0 + rows { [0.0; 2] } else { place };
        check(expected, 61, &[&stand([0.5, 0.7], one), &stand([0.9, 0.3], other)]);
    }
    // Two who stand and one who walks so far to the end of the area, along y.
    for (side, walk, expected) in [(1.45, 0.35, "Narrow"), (1.45, 0.25, "Crawling"), (1.55, 0.35, "Crawling")] {
        let (stand, go) = (|_| [0.1, 0.0], |t| [0.2, side - walk + walk / 60.0 * t]);
        check(expected, 61, &[&stand, &|_| [0.3, 0.5], &go]);
        check("Crawling", 61, &[&stand, &go]);
    }
    // Of so many rows all but some repeat the one before: a quarter, an eighth; for 1.2 and 1.4 s; 0.19 and 0.21 m.
    for (period, moves, metres, expected) in [
        (4.0, 3.0, 0.3, "Repeated"),
        (8.0, 7.0, 0.3, ""),
        (6.0, 1.0, 0.3, "Repeated"),
        (7.0, 1.0, 0.3, ""),
        (4.0, 3.0, 0.19, ""),
        (4.0, 3.0, 0.21, "Repeated"),
    ] {
        let count = |t: f64| (t / period).floor() * moves + (t % period).min(moves - 1.0);
        check(expected, 61, &[&|t| on_way(metres * count(t))]);
    }
    // A walk of 6 s that then keeps its place for 4 or 3.8 s.
    for (speed, rows, frozen) in [(0.31, 51, 1), (0.31, 50, 0), (0.29, 51, 0)] {
        let summary = tracks(rows, &[&|t: f64| on_way(0.2 * speed * t.min(30.0))]).summary();
        assert_eq!(summary.frozen, frozen, "{speed} {rows}");
    }
}

/// At 25 frames a second, a row every 5 frames: of 15 differences five are 5, seven are one more or less. Of 20 and 5
/// rows 17 are there.
#[test]
fn rows_are_summed_up_as_by_hand() {
    let frames = [0, 6, 10, 15, 21, 25, 30, 36, 61, 65, 70, 90, 96].map(|frame| (frame, 1));
    let rows = frames.into_iter().chain([5, 10, 15, 24].map(|frame| (frame, 2)));
    let rows = rows.map(|(frame, id)| Observation::new(frame, PedestrianId(id), [0.05 * frame as f64, -id as f64]));
    let recording = Recording::new("yard", 10, rows.collect()).unwrap();
    // The difference of 9 is a gap, too, where it is more than a step.
    assert_eq!(recording.clone().with_frame_step(2).unwrap().summary().holes, 3);
    let summary = recording.summary();
    let of_rows = [summary.rows_a_second.unwrap(), summary.jitter, summary.unseen];
    let is_near = |(a, b): (f64, f64)| (a - b).abs() < 1e-12;
    assert!(of_rows.into_iter().zip([5.0, 0.04, 0.32]).all(is_near), "{of_rows:?}");
    let gap = summary.longest_hole.unwrap();
    assert!(is_near((summary.seconds, 3.84)) && is_near((gap.seconds, 1.0)) && gap.after == 36);
    assert_eq!((summary.holes, summary.low, summary.high), (2, [0.0, -2.0], [4.800_000_000_000_001, -1.0]));
}
