//! Summaries of recordings and their plausibility checks.

use ddl_data::{Format, Observation, PedestrianId, PlausibilityWarning, Recording, parse_recording};

/// A pedestrian that walks along x at a speed in metres per frame, for 100 frames.
fn walk(metres_a_frame: f64) -> Vec<Observation> {
    (0..100)
        .map(|t| Observation::new(t, PedestrianId(1), [metres_a_frame * t as f64, 0.0]))
        .collect()
}

fn warnings(seen: Vec<Observation>) -> Vec<PlausibilityWarning> {
    Recording::new("yard", 1, seen).unwrap().summary().warnings()
}

#[test]
fn implausible_speeds_give_warnings() {
    // 1.3 m/s in steps of 0.4 s.
    assert_eq!(warnings(walk(0.52)), []);
    // The same walk at 25 frames per second, and in pixels.
    assert!(matches!(warnings(walk(0.052))[..], [PlausibilityWarning::Slow { brisk }] if brisk < 0.14));
    assert!(matches!(warnings(walk(30.0))[..], [PlausibilityWarning::Fast { median, .. }, ..] if median > 70.0));
    // A standing pedestrian causes no warning, even with the noise of a tracker.
    let stand = |id: i64, t: i64| Observation::new(t, PedestrianId(id), [0.03 * (t * t % 7) as f64, id as f64]);
    assert_eq!(warnings((0..100).map(|t| stand(1, t)).collect()), []);
    // Those who walk among more who stand show a wrong unit too.
    let crowd = (0..100).flat_map(|t| [2, 3].map(|id| stand(id, t)));
    let among = warnings(walk(3.0).into_iter().chain(crowd).collect());
    assert!(
        among[0]
            .to_string()
            .starts_with("half of the steps of walking pedestrians"),
        "{among:?}"
    );
    // A steady walk in kilometres.
    assert!(matches!(warnings(walk(5e-4))[..], [PlausibilityWarning::Crawling { speed }] if speed < 2e-3));
    // Detections once a second, each written ten times.
    let held = |t: i64| Observation::new(t, PedestrianId(1), [1.3 * (t / 10) as f64, 0.0]);
    let held = Recording::new("yard", 4, (0..200).map(held).collect()).unwrap();
    assert!(matches!(held.speed_warning(), Some(PlausibilityWarning::Repeated { share }) if share > 0.8));
    // Two who are not seen for some steps.
    let absent = |id, t| Observation::new(t, PedestrianId(id), [0.0; 2]);
    let seen = [
        walk(0.52),
        (100..120).flat_map(|t| [absent(1, t), absent(2, t)]).collect(),
    ]
    .concat();
    assert!(matches!(
        warnings(seen)[..],
        [
            PlausibilityWarning::Placeholders {
                rows: 41,
                pedestrians: 2
            },
            ..
        ]
    ));
    // A walk through a park in degrees of latitude.
    assert!(matches!(warnings(walk(5e-6))[..], [PlausibilityWarning::Still { farthest }] if farthest < 1e-3));
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
    let whole = Recording::new("yard", 1, walk(0.5)).unwrap().summary();
    assert_eq!(whole.unseen.to_bits(), 0.0_f64.to_bits());
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
    assert!(
        warnings[0]
            .to_string()
            .contains("pedestrian 1 jumps in the step that ends at frame 40")
    );
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
    let few = Recording::new("yard", 1, walk(0.5)[..12].to_vec()).unwrap();
    assert_eq!(few.summary().warnings(), [PlausibilityWarning::NothingToLearnFrom]);
}

/// Coordinates from 0 to 1 of a picture; people who stand together are no such case.
#[test]
fn shares_of_a_picture_are_doubted() {
    let crowd = |scale: f64, walk: f64| -> Vec<Observation> {
        let places = (0..3_i64).flat_map(|id| (0..12_i64).map(move |t| (id, t)));
        let place = |(id, t): (i64, i64)| [scale * (0.1 * id as f64 + walk * t as f64), scale * 0.3 * id as f64];
        places
            .map(|(id, t)| Observation::new(t, PedestrianId(id), place((id, t))))
            .collect()
    };
    let is_doubted = |seen| {
        let warnings = warnings(seen);
        warnings
            .iter()
            .any(|warning| matches!(warning, PlausibilityWarning::Narrow { .. }))
    };
    assert!(is_doubted(crowd(1.0, 0.05)));
    assert!(!is_doubted(crowd(10.0, 0.05)) && !is_doubted(crowd(1.0, 0.001)));
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
    ] {
        for head in ["frame", "time"] {
            let text = format!("{head},id,x,y\n{},0,0\n", rows.replace(' ', ",0,0\n"));
            let recording = parse_recording(text.as_bytes(), "f", Format::Table).unwrap();
            assert_eq!(recording.summary().restarts, count, "{text}");
        }
    }
}
