//! Recall agrees with a search through all segments, for any order of the pedestrians and any origin.

use std::collections::BTreeMap;

use crate::{Frames, memory_of, queries, step_of};
use ddl_core::{OBSERVED, PedestrianId, Position, RememberedTrack, WINDOW};
use ddl_memory::SceneMemory;
use proptest::prelude::*;

type Segment = [Position; WINDOW];

/// The segments of every pedestrian, by id and frame of the first observation; and whether the track is running.
fn segments(frames: &Frames) -> Vec<(PedestrianId, bool, Vec<Segment>)> {
    let (step, now) = (step_of(frames), frames[frames.len() - 1].0);
    let mut tracks: BTreeMap<(PedestrianId, i64), BTreeMap<i64, Position>> = BTreeMap::new();
    let mut current: BTreeMap<PedestrianId, (i64, i64)> = BTreeMap::new();
    for (frame, pedestrians) in frames {
        for (id, position) in pedestrians {
            let (first, last) = current.entry(*id).or_insert((*frame, *frame));
            if frame - *last > 8 * step {
                *first = *frame;
            }
            let track = tracks.entry((*id, *first)).or_default();
            if let Some(&before) = track.get(last).filter(|_| frame - *last <= 3 * step) {
                for due in (*last + step..*frame).step_by(step as usize) {
                    let share = (due - *last) as f64 / (frame - *last) as f64;
                    track.insert(due, ddl_core::between(before, *position, share));
                }
            }
            track.insert(*frame, *position);
            *last = *frame;
        }
    }
    let pedestrian = |((id, _), track): ((PedestrianId, i64), BTreeMap<i64, Position>)| {
        let segment = |first: &i64| {
            let position = |t: usize| track.get(&(first + t as i64 * step)).copied();
            let positions: Option<Vec<Position>> = (0..WINDOW).map(position).collect();
            positions?.try_into().ok()
        };
        let last = track.last_key_value().map_or(0, |(frame, _)| *frame);
        let segments = track.keys().filter_map(segment).collect();
        (id, now - last <= 8 * step, segments)
    };
    tracks.into_iter().map(pedestrian).collect()
}

fn distance(a: &[Position], b: &[Position]) -> f64 {
    let squared = |d: [f64; 2], scale: f64| (d[0] * d[0] + d[1] * d[1]) / (scale * scale);
    let between = |a: Position, b: Position| [a[0] - b[0], a[1] - b[1]];
    let velocity = |track: &[Position], from: usize| between(track[from + 3], track[from]).map(|way| way / 1.2);
    squared(between(a[7], b[7]), 1.0)
        + squared(between(velocity(a, 4), velocity(b, 4)), 0.4)
        + squared(between(velocity(a, 0), velocity(b, 0)), 0.6)
}

/// The smallest distance of each pedestrian except `pedestrian`, in order, below the limit.
fn reference(frames: &Frames, observed: &[Position; OBSERVED], pedestrian: Option<PedestrianId>) -> Vec<f64> {
    let others = segments(frames).into_iter().filter(|(id, runs, _)| !(*runs && Some(*id) == pedestrian));
    let nearest = others.map(|(_, _, segments)| {
        segments.iter().map(|segment| distance(segment, observed)).fold(f64::INFINITY, f64::min)
    });
    let mut nearest: Vec<f64> = nearest.filter(|d| *d < 60.0).collect();
    nearest.sort_by(f64::total_cmp);
    nearest
}

fn is_near(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-4 * (1.0 + a.abs())
}

fn is_alike(a: &[RememberedTrack], b: &[RememberedTrack]) -> bool {
    let mut pairs = a.iter().zip(b);
    a.len() == b.len() && pairs.all(|(a, b)| is_near(a.distance, b.distance))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn a_recall_agrees_with_a_search_through_all_stretches(frames in crate::crowds(), count in 0..20_usize) {
        let memory = memory_of(&frames, SceneMemory::DEFAULT_CAPACITY);
        let held_segments: Vec<Segment> = segments(&frames).into_iter().flat_map(|track| track.2).collect();
        prop_assert_eq!(memory.segments(), held_segments.len());
        for (id, observed) in queries(&frames) {
            for left_out in [Some(id), None, Some(PedestrianId(-1))] {
                let expected = reference(&frames, &observed, left_out);
                let recalled = memory.recall(&observed, left_out, count);
                prop_assert_eq!(recalled.len(), expected.len().min(count));
                for (example, expected) in recalled.iter().zip(expected) {
                    prop_assert!(is_near(example.distance, expected));
                    prop_assert!(is_near(distance(&example.track, &observed), expected));
                    prop_assert!(held_segments.contains(&example.track));
                }
            }
        }
    }

    /// Somebody seen for the first time may move like anybody nearby.
    #[test]
    fn a_place_recalls_all_motions(frames in crate::crowds(), x in -3.0..9.0, y in -3.0..9.0, count in 0..20_usize) {
        let memory = memory_of(&frames, SceneMemory::DEFAULT_CAPACITY);
        let squared = |segment: &Segment| ddl_core::distance(segment[OBSERVED - 1], [x, y]).powi(2);
        let nearest = segments(&frames).into_iter().filter_map(|(.., segments)| {
            segments.iter().map(squared).min_by(f64::total_cmp).filter(|squared| *squared < 60.0)
        });
        let mut nearest: Vec<f64> = nearest.collect();
        nearest.sort_by(f64::total_cmp);
        let recalled = memory.recall_at([x, y], None, count);
        prop_assert_eq!(recalled.len(), nearest.len().min(count));
        for (example, expected) in recalled.iter().zip(nearest) {
            prop_assert!(is_near(example.distance, expected) && is_near(squared(&example.track), expected));
        }
    }

    #[test]
    fn the_order_of_pedestrians_does_not_matter(frames in crate::crowds(), seed in any::<u64>()) {
        let memory = memory_of(&frames, 100);
        let mut shuffled = frames.clone();
        for (frame, pedestrians) in &mut shuffled {
            pedestrians.sort_by_key(|(id, _)| (id.0 as u64 + *frame as u64).wrapping_mul(seed | 1));
        }
        prop_assert_eq!(memory_of(&shuffled, 100), memory);
    }

    /// UTM coordinates, of which an `f32` resolves only half a metre; and an origin that is corrected later.
    #[test]
    fn recall_is_exact_far_from_the_origin(
        mut frames in crate::crowds(),
        far in (-9.9e6..9.9e6, -9.9e6..9.9e6),
    ) {
        let first = PedestrianId(i64::MAX);
        frames[0].1.push((first, [0.0; 2]));
        let memory = memory_of(&frames, 1_000);
        let mut moved = frames.clone();
        for (_, position) in moved.iter_mut().flat_map(|(_, pedestrians)| pedestrians).filter(|seen| seen.0 != first) {
            *position = [position[0] + far.0, position[1] + far.1];
        }
        let there = memory_of(&moved, 1_000);
        for ((id, here), (_, far)) in queries(&frames).into_iter().zip(queries(&moved)) {
            let (a, b) = (memory.recall(&here, Some(id), 12), there.recall(&far, Some(id), 12));
            prop_assert!(is_alike(&a, &b), "{a:?} {b:?}");
        }
    }
}

/// Five pedestrians that walk alike: two tracks have ended, one of them with the id of the query.
#[test]
fn only_the_running_track_is_left_out() {
    let mut memory = SceneMemory::new(1, 1_000).unwrap();
    let position = |t: i64| [0.5 * t as f64, 0.0];
    for (first, ids) in [(0, [4, 3].as_slice()), (100, &[3, 1, 2])] {
        for t in 0..22 {
            let pedestrians = ids.iter().map(|&id| (PedestrianId(id), position(t)));
            memory.observe(first + t, pedestrians).unwrap();
        }
    }
    let observed: [Position; OBSERVED] = std::array::from_fn(|t| position(t as i64 + 1));
    let recalled = memory.recall(&observed, Some(PedestrianId(3)), 12);
    assert_eq!(recalled.len(), 4);
    for example in &recalled {
        assert_eq!(example.track, std::array::from_fn(|t| position(t as i64 + 1)));
    }
    assert_eq!(memory.recall(&observed, None, 12).len(), 5);
    assert!(memory.recall(&observed, None, 0).is_empty());
    let unlike = memory.recall(&[[f64::NAN, 0.0]; OBSERVED], None, 12);
    assert!(unlike.is_empty());
}

/// A tracker whose origin is corrected while a pedestrian walks: the accuracy is the same before and after.
#[test]
fn a_jump_of_the_tracker_costs_no_precision() {
    for far in [40.0, 5e3, 9.9e6] {
        let mut memory = SceneMemory::new(1, 1_000).unwrap();
        let position = |t: usize| [0.5 * t as f64 + if t < 23 { 0.0 } else { far }, 0.0];
        for t in 0..60 {
            memory.observe(t as i64, [(PedestrianId(1), position(t))]).unwrap();
        }
        assert_eq!(memory.segments(), 41);
        for first in (0..41).filter(|first| !(14..24).contains(first)) {
            let observed = std::array::from_fn(|t| [position(first + t)[0] + 1e-3, 0.0]);
            let nearest = memory.recall(&observed, None, 1)[0];
            assert_eq!(nearest.track, std::array::from_fn(|t| position(first + t)));
            assert!((nearest.distance - 1e-6).abs() < 1e-7, "{far} {first} {}", nearest.distance);
        }
    }
}

/// Two pedestrians that walked a millimetre to the left and to the right of the query.
#[test]
fn ties_go_by_age() {
    let mut memory = SceneMemory::new(1, 1_000).unwrap();
    for (first, id, y) in [(0, 9, 0.001), (100, 2, -0.001)] {
        for t in 0..20 {
            let pedestrians = [(PedestrianId(id), [0.5 * t as f64, y])];
            memory.observe(first + t, pedestrians).unwrap();
        }
    }
    let observed = std::array::from_fn(|t| [0.5 * t as f64, 0.0]);
    let sides = |count| {
        memory.recall(&observed, None, count).iter().map(|example| example.track[0][1] > 0.0).collect::<Vec<bool>>()
    };
    assert_eq!((sides(1), sides(2)), (vec![true], vec![true, false]));
}

/// A pedestrian at 1.2 m/s whose rows lie at other times than the steps after the first one: the positions at the steps
/// lie between them. By the frames of 40 s and the frames of a step: 10 Hz, also with lost rows (four in a row, and
/// those of two steps in a row), milliseconds that jitter, 7 and 1 frames a second in parts, every third frame at 25.
#[test]
fn rows_between_the_steps_give_segments() {
    let lost = |k: &i64| ![4, 5, 6, 7, 20, 24].contains(&(k % 30));
    let films: [(i64, Vec<i64>); 6] = [
        (4, (0..=400).collect()),
        (4, (0..=400).filter(lost).collect()),
        (400, (0..=400).map(|k| 100 * k + (k * k * 7) % 21).collect()),
        (14, (0..=280).map(|k| 5 * k).collect()),
        (2, (0..=40).map(|k| 5 * k).collect()),
        (10, (0..=1_000).step_by(3).chain([1_000]).collect()),
    ];
    for (step, frames) in films {
        let mut memory = SceneMemory::new(step, 1_000).unwrap();
        for &frame in &frames {
            memory.observe(frame, [(PedestrianId(1), [0.48 * frame as f64 / step as f64, 2.0])]).unwrap();
        }
        let track: Vec<Position> = memory.tracks().next().unwrap();
        let off = |(k, place): (usize, &Position)| (place[0] - 0.48 * k as f64).hypot(place[1] - 2.0);
        assert!(track.iter().enumerate().map(off).all(|off| off < 1e-4), "{step}: {track:?}");
        assert_eq!((track.len(), memory.segments()), (101, 82), "{step}, {} frames", frames.len());
    }
}

/// Rows are not joined over more than 1.2 s (a step has ten frames).
#[test]
fn long_gaps_begin_another_run() {
    for (spacing, resumed, segments) in
        [(10, 310, 42), (10, 320, 43), (10, 340, 23), (1, 311, 43), (1, 321, 44), (1, 329, 44), (1, 331, 23)]
    {
        let mut memory = SceneMemory::new(10, 1_000).unwrap();
        let then = (resumed..resumed + 300).step_by(spacing);
        for frame in (0..=300).step_by(spacing).chain(then) {
            memory.observe(frame, [(PedestrianId(1), [0.05 * frame as f64, 0.0])]).unwrap();
        }
        assert_eq!(memory.segments(), segments, "{spacing} {resumed}");
    }
}

/// A track that begins anew is not joined to the earlier track of the same id.
#[test]
fn tracks_that_begin_anew_are_not_joined() {
    let mut memory = SceneMemory::new(4, 1_000).unwrap();
    for frame in 0..240 {
        let row = [(PedestrianId(1), [0.12 * frame as f64, if frame < 118 { 0.0 } else { 3.0 }])];
        let begun: &[_] = if frame == 118 { &[PedestrianId(1)] } else { &[] };
        memory.observe_begun(frame, row, begun).unwrap();
    }
    let track = memory.tracks().next().unwrap();
    assert!(track.iter().all(|[_, y]| [0.0, 3.0].contains(y)), "{track:?}");
    assert_eq!((memory.segments(), memory.summary().pedestrians), (11 + 12, 1));
}

/// The positions of all pedestrians, each once, without gaps; pedestrians without a segment are left out.
#[test]
fn tracks_are_the_positions_held() {
    let mut memory = SceneMemory::new(1, 1_000).unwrap();
    let position = |t: i64| [0.5 * t as f64, 0.0];
    for t in 0..70 {
        let third = (t > 60).then_some((PedestrianId(3), [1.0; 2]));
        let second = (t < 25).then_some((PedestrianId(2), [0.5 * t as f64, 3.0]));
        let first = (!(40..44).contains(&t)).then_some((PedestrianId(1), position(t)));
        memory.observe(t, [first, second, third].into_iter().flatten()).unwrap();
    }
    let tracks: Vec<Vec<Position>> = memory.tracks().collect();
    let second: Vec<Position> = (0..25).map(|t| [position(t)[0], 3.0]).collect();
    assert_eq!(tracks, [second, (0..40).chain(44..70).map(position).collect()]);
}
