//! A full memory: never above its capacity, and the newest stay.

use crate::{crowd::Crowd, memory_of, queries};
use ddl_data::{OBSERVED, PedestrianId, Position};
use ddl_memory::{MOST_PIECES, SceneMemory};
use proptest::prelude::*;

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn the_capacity_is_never_exceeded(frames in crate::crowds(), capacity in 1..200_usize) {
        let mut memory = SceneMemory::new(crate::step_of(&frames), capacity).unwrap();
        let mut whole = SceneMemory::new(crate::step_of(&frames), 20_000).unwrap();
        for (frame, people) in &frames {
            let before = whole.stretches();
            memory.observe(*frame, people.clone()).unwrap();
            whole.observe(*frame, people.clone()).unwrap();
            prop_assert!(memory.stretches() <= capacity);
            prop_assert!(memory.stretches() >= (whole.stretches() - before).min(1));
        }
        if whole.stretches() <= capacity {
            for (id, observed) in queries(&frames) {
                let recalled = whole.recall(&observed, Some(id), 12);
                prop_assert_eq!(memory.recall(&observed, Some(id), 12), recalled);
            }
        }
        memory.interrupt();
        prop_assert_eq!(memory.last_frame(), None);
    }
}

fn walk(memory: &mut SceneMemory, first: i64, y: f64) {
    for t in 0..20 {
        let people = [(PedestrianId(first), [0.5 * t as f64, y])];
        memory.observe(first + t, people).unwrap();
    }
}

/// Many take one way and one takes another: of the many the oldest go, and the newest are all there.
#[test]
fn the_oldest_of_a_common_kind_go_first() {
    let mut memory = SceneMemory::new(1, 64).unwrap();
    walk(&mut memory, 0, 100.0);
    for walker in 1..200 {
        walk(&mut memory, 100 * walker, 1e-4 * walker as f64);
    }
    let observed =
        |y: f64| -> [Position; OBSERVED] { std::array::from_fn(|t| [0.5 * t as f64, y]) };
    let common = memory.recall(&observed(0.0199), None, 100).examples;
    let mut walkers: Vec<i64> = common
        .iter()
        .map(|example| (example.track[0][1] * 1e4).round() as i64)
        .collect();
    walkers.sort_unstable();
    assert_eq!(
        walkers,
        (200 - walkers.len() as i64..200).collect::<Vec<_>>()
    );
    assert!((60..64).contains(&walkers.len()), "{walkers:?}");
    assert_eq!(memory.recall(&observed(100.0), None, 12).examples.len(), 1);
}

/// Everybody of the older half took a way of their own, and those of the newer half took the same: they stay.
#[test]
fn the_newer_half_stays() {
    let mut memory = SceneMemory::new(1, 64).unwrap();
    for walker in 0..65 {
        let y = if walker < 32 {
            -10.0 * walker as f64
        } else {
            50.0
        };
        walk(&mut memory, 100 * walker, y);
    }
    let observed = std::array::from_fn(|t| [0.5 * t as f64, 50.0]);
    assert_eq!(memory.recall(&observed, None, 100).examples.len(), 33);
    assert_eq!(memory.stretches(), 63);
}

#[test]
fn who_stays_for_hours_does_not_fill_a_memory() {
    let mut memory = SceneMemory::new(1, 1_000).unwrap();
    walk(&mut memory, -100, 3.0);
    for frame in 0..20_000 {
        memory
            .observe(frame, [(PedestrianId(1), [1e-3 * frame as f64, 0.0])])
            .unwrap();
    }
    let most = 8 * MOST_PIECES;
    assert!(
        (most - 7..=most + 1).contains(&memory.stretches()),
        "{}",
        memory.stretches()
    );
    let newest: [Position; OBSERVED] = std::array::from_fn(|t| [1e-3 * (19_980 + t) as f64, 0.0]);
    assert!(memory.recall(&newest, None, 1).examples[0].distance < 1e-9);
    let summary = memory.summary();
    assert_eq!(
        (summary.tracks, summary.frames, summary.observations),
        (2, 20_020, 20_020)
    );
    assert_eq!(summary.corners, Some([[0.0, 0.0], [19.999, 3.0]]));
}

/// As many running tracks as there are people, who all stay.
#[test]
fn where_all_are_there_the_longest_track_gives_way() {
    let mut crowd = Crowd::new(4, 30);
    let still = crowd.step();
    let mut memory = SceneMemory::new(1, 100).unwrap();
    for frame in 0..60 {
        memory.observe(frame, still.clone()).unwrap();
        assert!(memory.stretches() <= 100);
    }
    assert!(memory.summary().tracks > 20);
    let frames = vec![(0, still)];
    assert_eq!(memory_of(&frames, 1).stretches(), 0);
}
