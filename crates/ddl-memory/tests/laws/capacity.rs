//! A full memory never exceeds its capacity, and keeps the newest tracks.

use crate::{crowd::Crowd, memory_of, queries};
use ddl_core::{OBSERVED, PedestrianId, Position};
use ddl_memory::SceneMemory;
use proptest::prelude::*;

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn the_capacity_is_never_exceeded(frames in crate::crowds(), capacity in 1..200_usize) {
        let mut memory = SceneMemory::new(crate::step_of(&frames), capacity).unwrap();
        let mut whole = SceneMemory::new(crate::step_of(&frames), 20_000).unwrap();
        for (frame, pedestrians) in &frames {
            memory.observe(*frame, pedestrians.clone()).unwrap();
            whole.observe(*frame, pedestrians.clone()).unwrap();
            prop_assert!(memory.segments() <= capacity);
        }
        if whole.segments() <= capacity {
            for (id, observed) in queries(&frames) {
                let recalled = whole.recall(&observed, Some(id), 12);
                prop_assert_eq!(memory.recall(&observed, Some(id), 12), recalled);
            }
        }
        memory.end_tracks();
        prop_assert_eq!(memory.last_frame(), None);
    }
}

fn walk(memory: &mut SceneMemory, first: i64, y: f64) {
    for t in 0..20 {
        let pedestrians = [(PedestrianId(first), [0.5 * t as f64, y])];
        memory.observe(first + t, pedestrians).unwrap();
    }
}

fn observed(y: f64) -> [Position; OBSERVED] {
    std::array::from_fn(|t| [0.5 * t as f64, y])
}

/// Many pedestrians take one path, and one pedestrian takes another. The oldest tracks on the common path are removed,
/// and the other track stays.
#[test]
fn repeated_tracks_are_removed_first_oldest_first() {
    let mut memory = SceneMemory::new(1, 64).unwrap();
    walk(&mut memory, 0, 100.0);
    for pedestrian in 1..200 {
        walk(&mut memory, 100 * pedestrian, 1e-3 * pedestrian as f64);
    }
    let common = memory.recall(&observed(0.1), None, 100);
    let number = |y: f64| (y * 1e3).round() as i64;
    let mut pedestrians: Vec<i64> = common.iter().map(|it| number(it.track[0][1])).collect();
    pedestrians.sort_unstable();
    assert_eq!(pedestrians, (200 - pedestrians.len() as i64..200).collect::<Vec<_>>());
    assert!((60..64).contains(&pedestrians.len()), "{pedestrians:?}");
    assert_eq!(memory.recall(&observed(100.0), None, 12).len(), 1);
}

/// Every pedestrian takes a different path.
#[test]
fn without_repetition_the_oldest_tracks_are_removed() {
    let mut memory = SceneMemory::new(1, 64).unwrap();
    for pedestrian in 0..100 {
        walk(&mut memory, 100 * pedestrian, 10.0 * pedestrian as f64);
    }
    let is_held = |pedestrian: &i64| !memory.recall(&observed(10.0 * *pedestrian as f64), None, 1).is_empty();
    let held: Vec<i64> = (0..100).filter(is_held).collect();
    assert_eq!(held, (100 - held.len() as i64..100).collect::<Vec<_>>());
    assert_eq!(held.len(), memory.segments());
}

/// 60 pedestrians stand for ten minutes, with tracker noise of some centimetres; one of them leaves at the end.
#[test]
fn standing_pedestrians_do_not_displace_passing_ones() {
    let mut memory = SceneMemory::new(1, 2_500).unwrap();
    for pedestrian in 0..900 {
        walk(&mut memory, 100 * pedestrian - 100_000, 3.0 * pedestrian as f64);
    }
    let mut crowd = Crowd::new(4, 60);
    let still = crowd.step();
    let mut tremble = || 0.1 * (crowd.random() - 0.5);
    for frame in 0..1_500 {
        let away = 0.4 * (frame - 1_470).max(0) as f64;
        let moved = |&(id, [x, y]): &(PedestrianId, Position)| {
            let x = if id == still[0].0 { x - away } else { x };
            (id, [x + tremble(), y + tremble()])
        };
        memory.observe(frame, still.iter().map(moved)).unwrap();
    }
    assert_eq!(memory.summary().tracks, 960);
    assert!(memory.segments() <= 900 + 60 * 24 + 24, "{}", memory.segments());
    let leaving = std::array::from_fn(|t| {
        let [x, y] = still[0].1;
        [x - 0.4 * t as f64, y]
    });
    assert!(memory.recall(&leaving, None, 1)[0].distance < 2.0);
}

#[test]
fn a_pedestrian_walking_about_for_hours_does_not_fill_a_memory() {
    let mut memory = SceneMemory::new(1, 1_000).unwrap();
    walk(&mut memory, -100, 3.0);
    for frame in 0..20_000 {
        memory.observe(frame, [(PedestrianId(1), [0.5 * frame as f64, 0.0])]).unwrap();
    }
    let most = 8 * 32;
    assert!((most - 7..=most + 1).contains(&memory.segments()), "{}", memory.segments());
    let newest: [Position; OBSERVED] = std::array::from_fn(|t| [0.5 * (19_980 + t) as f64, 0.0]);
    assert!(memory.recall(&newest, None, 1)[0].distance < 1e-9);
    let summary = memory.summary();
    assert_eq!((summary.tracks, summary.frames, summary.pedestrians), (2, 20_020, 2));
    assert_eq!(summary.extent, Some([[0.0, 0.0], [9_999.5, 3.0]]));
}

/// All tracks are running, because all pedestrians stay.
#[test]
fn if_all_tracks_are_running_the_longest_is_shortened() {
    let mut crowd = Crowd::new(4, 30);
    let still = crowd.step();
    let mut memory = SceneMemory::new(1, 100).unwrap();
    for frame in 0..60 {
        memory.observe(frame, still.clone()).unwrap();
        assert!(memory.segments() <= 100);
    }
    assert!(memory.summary().tracks > 20);
    let frames = vec![(0, still)];
    assert_eq!(memory_of(&frames, 1).segments(), 0);
}
