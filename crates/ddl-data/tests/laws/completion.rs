//! Completion of observations: what is filled in, and what is never changed.

use std::collections::BTreeMap;

use ddl_data::{Completion, CompletionCounts, OBSERVED, Observation, PedestrianId, Position, Recording, Window};
use proptest::prelude::*;

const STEP: i64 = 4;

/// Frames at which a pedestrian is seen: mostly one step apart, with gaps, and occasionally at other times.
fn frames() -> impl Strategy<Value = Vec<i64>> {
    let later = prop_oneof![
        12 => Just(STEP),
        3 => Just(2 * STEP),
        2 => Just(3 * STEP),
        1 => Just(4 * STEP),
        1 => 1..3 * STEP,
    ];
    prop::collection::vec(later, 1..40).prop_map(|gaps| {
        let add = |frame: &mut i64, later: i64| {
            *frame += later;
            Some(*frame)
        };
        gaps.into_iter().scan(-50, add).collect()
    })
}

fn recording(tracks: &[Vec<(i64, Position)>]) -> Recording {
    let of_track = |(id, track): (i64, &Vec<(i64, Position)>)| -> Vec<Observation> {
        let seen = track.iter();
        seen.map(|&(frame, place)| Observation::new(frame, PedestrianId(id), place))
            .collect()
    };
    let seen = (0..).zip(tracks).flat_map(of_track).collect();
    Recording::new("yard", STEP, seen).unwrap()
}

/// The result by the definition: a search in the whole track of a pedestrian that is present at the frame `until`.
fn by_search(
    track: &BTreeMap<i64, Position>,
    until: i64,
    least_seen: usize,
    longest_gap: i64,
) -> Option<([Position; OBSERVED], CompletionCounts)> {
    let mut places = Vec::new();
    let mut seen = 0;
    for k in 0..OBSERVED as i64 {
        let frame = until - k * STEP;
        if let Some(&place) = track.get(&frame) {
            places.push(place);
            seen += 1;
            continue;
        }
        let before = track.range(..frame).next_back();
        let after = track.range(frame..).next();
        let (Some((&t0, a)), Some((&t1, b))) = (before, after) else {
            break;
        };
        if longest_gap == 0 || t1 - t0 > (longest_gap + 1) * STEP {
            break;
        }
        let share = (frame - t0) as f64 / (t1 - t0) as f64;
        places.push([0, 1].map(|axis| a[axis] + share * (b[axis] - a[axis])));
    }
    if seen < least_seen {
        return None;
    }
    let (reached, last) = (places.len(), places[0]);
    let first = places[reached - 1];
    for back in 1..=OBSERVED - reached {
        let share = back as f64 / (reached - 1) as f64;
        places.push([0, 1].map(|axis| first[axis] - share * (last[axis] - first[axis])));
    }
    places.reverse();
    let counts = CompletionCounts {
        padded: OBSERVED - reached,
        filled: reached - seen,
    };
    Some((places.try_into().unwrap(), counts))
}

fn bits(track: &[Position]) -> Vec<[u64; 2]> {
    track.iter().map(|place| place.map(f64::to_bits)).collect()
}

proptest! {
    #[test]
    fn completion_agrees_with_a_search(
        tracks in prop::collection::vec(frames(), 1..5),
        places in prop::collection::vec(prop::array::uniform2(-9.0..9.0_f64), 40),
        (completion, least, gap) in prop_oneof![Just((Completion::NONE, 8, 0)), Just((Completion::DEFAULT, 2, 2))],
    ) {
        let tracks: Vec<Vec<(i64, Position)>> = tracks
            .into_iter()
            .map(|frames| frames.into_iter().zip(places.iter().copied()).collect())
            .collect();
        let recording = recording(&tracks);
        let windows = recording.completed_windows(completion);
        let mut windows = windows.iter().peekable();
        for &frame in recording.frames() {
            let expected: Vec<_> = (0..)
                .zip(&tracks)
                .filter_map(|(id, track)| {
                    let track: BTreeMap<i64, Position> = track.iter().copied().collect();
                    track.get(&frame)?;
                    let (places, counts) = by_search(&track, frame, least, gap)?;
                    Some((PedestrianId(id), bits(&places), counts))
                })
                .collect();
            let window = windows.next_if(|window| window.frames()[OBSERVED - 1] == frame);
            let actual: Vec<_> = window.map_or(Vec::new(), |window| {
                let ids = window.pedestrians().iter().enumerate();
                ids.map(|(i, &id)| (id, bits(window.observed(i)), window.completion_counts(i))).collect()
            });
            prop_assert_eq!(actual, expected, "frame {}", frame);
        }
        prop_assert!(windows.next().is_none());
    }
}

fn only_window(frames: &[i64], completion: Completion) -> Option<Window> {
    let track = frames.iter().map(|&frame| (frame, [frame as f64, 1.0]));
    let windows = recording(&[track.collect()]).completed_windows(completion);
    let last = *frames.last().unwrap();
    let mut windows = windows.into_iter();
    windows.find(|window| window.frames()[OBSERVED - 1] == last)
}

#[test]
fn holes_of_two_frames_are_filled_and_longer_ones_are_not() {
    let counts = |frames: &[i64]| {
        only_window(frames, Completion::DEFAULT).map(|window| {
            let CompletionCounts { padded, filled } = window.completion_counts(0);
            (padded, filled, window.completion_counts(0).seen())
        })
    };
    assert_eq!(counts(&[0, 4, 8, 12, 16, 20, 24, 28]), Some((0, 0, 8)));
    assert_eq!(counts(&[0, 4, 8, 20, 24, 28]), Some((0, 2, 6)));
    assert_eq!(counts(&[0, 4, 20, 24, 28]), Some((5, 0, 3)));
    assert_eq!(counts(&[0, 12, 24, 28]), Some((0, 4, 4)));
    assert_eq!(counts(&[20, 28]), Some((5, 1, 2)));
    assert_eq!(counts(&[28]), None);
    // Between two steps: this position does not count as an observation.
    assert_eq!(counts(&[22, 28]), None);
    assert_eq!(counts(&[18, 22, 28]), None);
    assert!(only_window(&[0, 4, 8, 20, 24, 28], Completion::NONE).is_none());
}
