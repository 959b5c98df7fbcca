//! Laws of windows, neighbours and rotations, on made-up recordings.

use ddl_core::{PedestrianId, Position, Rotation, SpatialIndex};
use ddl_data::{Observation, Recording, WindowRule};
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
    recording.at(start).iter().map(|o| o.pedestrian).filter(|&id| whole(id)).collect()
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
        let mut published = recording.windows(WindowRule::Published).into_iter();
        for whole in recording.windows(WindowRule::Complete) {
            let seen = |frame: i64| recording.at(frame).iter().filter(|seen| seen.position != [0.0, 0.0]);
            let mut beyond = seen(whole.start_frame() + 20 * 6);
            let goes_on = beyond.any(|late| seen(whole.start_frame()).any(|seen| seen.pedestrian == late.pedestrian));
            let pedestrians: Vec<_> = (0..whole.len())
                .filter(|&i| !whole.track(i).contains(&[0.0, 0.0]))
                .map(|i| whole.pedestrians()[i])
                .collect();
            if goes_on && !pedestrians.is_empty() {
                let window = published.next().unwrap();
                prop_assert_eq!((window.start_frame(), window.pedestrians()), (whole.start_frame(), &pedestrians[..]));
            }
        }
        prop_assert!(published.next().is_none());
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
    fn the_places_within_a_box_are_those_of_its_definition(
        places in prop::collection::vec(prop::array::uniform2(-20.0..20.0_f64), 0..12),
    ) {
        let index = SpatialIndex::new(&places);
        for a in &places {
            let near = |b: &Position| (a[0] - b[0]).abs() <= 10.0 && (a[1] - b[1]).abs() <= 10.0;
            let expected: Vec<usize> = (0..places.len()).filter(|&j| near(&places[j])).collect();
            let mut found: Vec<usize> = index.within_box(*a, 10.0).collect();
            found.sort_unstable();
            prop_assert_eq!(found, expected);
        }
    }
}

#[test]
fn rules_are_read_by_name() {
    let social_gan = |min_pedestrians| WindowRule::SocialGan { min_pedestrians };
    for (word, rule) in [
        ("published", WindowRule::Published),
        ("complete", WindowRule::Complete),
        ("observed", WindowRule::Observed),
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
