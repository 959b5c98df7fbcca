//! Laws of windows, neighbours and rotations, on made-up recordings.

use ddl_data::{
    Neighbours, OBSERVED, Observation, PedestrianId, Position, Recording, Remembered, Rotation, SpatialIndex, Window,
    WindowError, WindowRule,
};
use proptest::prelude::*;

const RULES: [WindowRule; 4] = [
    WindowRule::Published,
    WindowRule::Complete,
    WindowRule::SocialGan { min_pedestrians: 1 },
    WindowRule::SocialGan { min_pedestrians: 3 },
];

fn recording() -> impl Strategy<Value = Vec<Observation>> {
    let pedestrian = (0_i64..30, 1_i64..60, prop::collection::btree_set(0_i64..60, 0..3));
    (prop::collection::vec(pedestrian, 1..7), any::<bool>()).prop_map(|(pedestrians, origin)| {
        let mut rows = Vec::new();
        for (id, (start, length, missed)) in (0_i64..).zip(pedestrians) {
            for t in (0..length).filter(|t| !missed.contains(t)) {
                let here = [t as f64, id as f64];
                // A pedestrian that stands on the origin for a step: absent under the published rule.
                let place = if origin && t == 30 { [0.0, 0.0] } else { here };
                rows.push(Observation::new((start + t) * 6, PedestrianId(id), place));
            }
        }
        rows.push(Observation::new(0, PedestrianId(99), [1.0, 1.0]));
        rows
    })
}

/// The pedestrians with 20 steps in a row from a frame on, directly by the definition.
fn present(recording: &Recording, start: i64) -> Vec<PedestrianId> {
    let step = recording.frame_step();
    let here = |frame: i64, id| recording.at(frame).iter().any(|o| o.pedestrian == id);
    let whole = |id| (0..20).all(|t| here(start + t * step, id));
    recording
        .at(start)
        .iter()
        .map(|o| o.pedestrian)
        .filter(|&id| whole(id))
        .collect()
}

proptest! {
    #[test]
    fn tracks_of_windows_are_the_positions_of_the_recording(rows in recording()) {
        let recording = Recording::new("r", 6, rows).unwrap();
        for rule in RULES {
            for window in recording.windows(rule) {
                for (i, &id) in window.pedestrians().iter().enumerate() {
                    for (&frame, &position) in window.frames().iter().zip(window.track(i)) {
                        let seen = Observation::new(frame, id, position);
                        prop_assert!(recording.at(frame).contains(&seen));
                    }
                }
            }
        }
    }

    #[test]
    fn complete_windows_are_those_of_the_definition(rows in recording()) {
        let recording = Recording::new("r", 6, rows).unwrap();
        let mut windows = recording.windows(WindowRule::Complete).into_iter();
        for &frame in recording.frames() {
            let expected = present(&recording, frame);
            if !expected.is_empty() {
                let window = windows.next().unwrap();
                prop_assert_eq!(window.start_frame(), frame);
                prop_assert_eq!(window.pedestrians(), &expected[..]);
            }
        }
        prop_assert!(windows.next().is_none());
    }

    #[test]
    fn published_windows_are_complete_ones_without_those_at_the_origin(rows in recording()) {
        let recording = Recording::new("r", 6, rows).unwrap();
        let complete = recording.windows(WindowRule::Complete);
        for window in recording.windows(WindowRule::Published) {
            let whole = complete.iter().find(|w| w.start_frame() == window.start_frame()).unwrap();
            let kept: Vec<_> = (0..whole.len())
                .filter(|&i| !whole.track(i).contains(&[0.0, 0.0]))
                .map(|i| whole.pedestrians()[i])
                .collect();
            prop_assert_eq!(window.pedestrians(), &kept[..]);
            prop_assert!(recording.frames().contains(&(window.start_frame() + 20 * 6)));
        }
    }

    #[test]
    fn rotation_preserves_distances_and_can_be_undone(
        a in prop::array::uniform2(-100.0..100.0_f64),
        b in prop::array::uniform2(-100.0..100.0_f64),
        angle in -10.0..10.0_f64,
    ) {
        let turn = Rotation::new(angle);
        let gap = |a: Position, b: Position| (a[0] - b[0]).hypot(a[1] - b[1]);
        prop_assert!((gap(a, b) - gap(turn.apply(a), turn.apply(b))).abs() < 1e-10);
        prop_assert!(gap(Rotation::new(-angle).apply(turn.apply(a)), a) < 1e-10);
    }

    /// Coarse coordinates make many distances equal; map coordinates are rounded.
    #[test]
    fn the_nearest_others_are_those_that_sorting_finds(
        grid in prop::collection::vec(prop::array::uniform2(0..6_u8), 1..40),
        count in 0_usize..10,
        unit in prop_oneof![Just(1.0), 0.1..0.2_f64],
        origin in prop_oneof![Just(0.0), Just(5.8e6)],
    ) {
        let positions: Vec<Position> = grid.iter()
            .map(|cell| cell.map(|x| origin + unit * f64::from(x)))
            .collect();
        let places = SpatialIndex::new(&positions);
        for (i, here) in positions.iter().enumerate() {
            let distance = |j: &usize| {
                let there = positions[*j];
                (there[0] - here[0]).hypot(there[1] - here[1])
            };
            let mut others: Vec<usize> = (0..positions.len()).filter(|&j| j != i).collect();
            others.sort_by(|a, b| distance(a).total_cmp(&distance(b)));
            others.truncate(count);
            prop_assert_eq!(places.nearest_others(i, *here, count), others);
        }
    }

    #[test]
    fn neighbours_are_others_within_the_box(
        places in prop::collection::vec(prop::array::uniform2(-20.0..20.0_f64), 0..12),
    ) {
        let mask = Neighbours::within_box(&places, 10.0);
        prop_assert_eq!(mask.len(), places.len());
        let mut pairs = Vec::new();
        for (i, a) in places.iter().enumerate() {
            for (j, b) in places.iter().enumerate() {
                let near = (a[0] - b[0]).abs() <= 10.0 && (a[1] - b[1]).abs() <= 10.0;
                prop_assert_eq!(mask.of(i).contains(&(j as u32)), near && i != j);
                pairs.extend((near && i != j).then_some((i, j)));
            }
        }
        prop_assert_eq!(mask.pairs().collect::<Vec<_>>(), pairs);
    }
}

fn ids(range: std::ops::Range<i64>) -> Vec<PedestrianId> {
    range.map(PedestrianId).collect()
}

#[test]
fn invalid_windows_are_refused() {
    let track = |length: usize| vec![[0.0, 0.0]; length];
    let mut spoiled = track(20);
    spoiled[11] = [0.0, f64::NAN];
    let new = |start, step, ids, tracks| Window::new("r", start, step, ids, tracks).unwrap_err();
    let refused = |ids, tracks, message: &str| {
        let error = new(0, 10, ids, tracks).to_string();
        assert!(error.starts_with(message), "{error}");
    };
    refused(vec![], vec![], "a window needs at least one pedestrian");
    refused(ids(0..2), vec![track(20)], "2 pedestrian ids but 1 tracks");
    refused(ids(0..1), vec![track(9)], "pedestrian 0: a track of 9 positions");
    let unequal = vec![track(20), track(8)];
    refused(ids(0..2), unequal, "pedestrian 1: a track of 8");
    refused(ids(0..1), vec![spoiled], "pedestrian 0, position 11 of the track");
    let twice = vec![PedestrianId(1), PedestrianId(1)];
    refused(twice, vec![track(8); 2], "pedestrian 1 is in the window twice");
    for (start, step) in [(0, 0), (0, -10), (i64::MAX, 10), (0, i64::MAX)] {
        let refused = new(start, step, ids(0..1), vec![track(20)]);
        assert!(matches!(refused, WindowError::Frames { .. }));
    }
}

#[test]
fn changing_positions_changes_nothing_else() {
    let tracks = vec![(0..20).map(|t| [f64::from(t), 0.0]).collect(), vec![[5.0, 5.0]; 20]];
    let window = Window::new("r", 100, 6, ids(4..6), tracks).unwrap();
    let alone = window.filter_pedestrians(|i| i == 1).unwrap();
    assert_eq!(alone.pedestrians(), ids(5..6));
    assert_eq!(
        (alone.track(0), window.filter_pedestrians(|_| false)),
        (window.track(1), None)
    );
    let later = |_, step, [x, y]: Position| {
        if step >= OBSERVED { [x + 1.0, y] } else { [x, y] }
    };
    let changed = window.map_positions(later);
    assert_eq!(window.reversed().track(0)[..2], [[19.0, 0.0], [18.0, 0.0]]);
    assert_eq!(window.reversed().reversed(), window);
    assert_eq!(changed.without_future(), window.without_future());
    assert_ne!(changed.end(0), window.end(0));
    assert_eq!(
        (window.frames()[19], window.steps(), window.has_future()),
        (214, 20, true)
    );
    let observation = window.without_future();
    assert_eq!((observation.frames().len(), observation.has_future()), (8, false));
    assert!(observation.future(0).is_empty() && observation.end(0).is_none());
    assert_eq!(observation.track(0), window.observed(0));
}

#[test]
fn rules_are_read_by_name() {
    let social_gan = |min_pedestrians| WindowRule::SocialGan { min_pedestrians };
    for (word, rule) in [
        ("published", WindowRule::Published),
        ("complete", WindowRule::Complete),
        ("social-gan", social_gan(2)),
        ("social-gan-1", social_gan(1)),
        ("social-gan-7", social_gan(7)),
    ] {
        assert_eq!(word.parse(), Ok(rule));
    }
    for word in ["social-gan-0", "social-gan-", "social-gan-few", ""] {
        let error = word.parse::<WindowRule>().unwrap_err().to_string();
        assert!(error.contains("social-gan-1"), "{error}");
    }
}

#[test]
fn remembered_tracks_stay_with_their_pedestrian() {
    let tracks = (0..3).map(|i| vec![[f64::from(i), 0.0]; 20]).collect();
    let ids = (1..4).map(PedestrianId).collect();
    let remembered = |i: usize| Remembered {
        track: [[i as f64, 1.0]; 20],
        distance: i as f64,
    };
    let window = Window::new("yard", 0, 10, ids, tracks).unwrap();
    assert!((0..3).all(|i| window.remembered(i).is_empty()));
    let remembering = window
        .clone()
        .with_remembered(|i| (0..i).map(|_| remembered(i)).collect());
    assert_eq!(remembering.remembered(2), [remembered(2); 2]);
    assert_eq!(remembering.without_future().remembered(2), [remembered(2); 2]);
    let kept = remembering.filter_pedestrians(|i| i != 1).unwrap();
    assert_eq!(kept.remembered(0), []);
    assert_eq!(kept.remembered(1), [remembered(2); 2]);
    // Reversal drops it, because it would lie in the future.
    assert_eq!(remembering.reversed(), window.reversed());
    assert_eq!(remembering.with_remembered(|_| Vec::new()), window);
}
