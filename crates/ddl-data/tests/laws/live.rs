//! Tracks fed frame by frame give the windows that are cut from the whole recording.

use ddl_data::{
    Completion, Convention, LiveError, LiveTracks, OBSERVED, Observation, PedestrianId, Position,
    Recording, Window,
};
use proptest::prelude::*;

use crate::recordings;

const STEP: i64 = 6;

type People = Vec<(PedestrianId, Position)>;

fn people(observations: &[Observation]) -> People {
    let one = |o: &Observation| (o.pedestrian, o.position);
    // Not in order: a tracker has none.
    observations.iter().rev().map(one).collect()
}

/// The windows of a recording, its frames pushed one after the other.
fn live_windows(recording: &Recording) -> Vec<Window> {
    let mut tracks = LiveTracks::with_frame_step(recording.frame_step()).unwrap();
    let frames = recording.frames().iter();
    frames
        .filter_map(|&frame| tracks.push(frame, people(recording.at(frame))).unwrap())
        .collect()
}

/// The same, cut from the whole.
fn cut_windows(recording: &Recording) -> Vec<Window> {
    recording.clone().with_name("live").observed_windows()
}

/// Who is where in each of some frames, and how many raw frames each is after the one before: mostly one step,
/// now and then more, and not always a whole number of steps.
fn frames() -> impl Strategy<Value = Vec<(i64, People)>> {
    let place = prop::array::uniform2(-20.0..20.0_f64);
    let crowd = prop::collection::vec(prop::option::weighted(0.9, place), 5);
    // A tracker that keeps time, and one that is faster than the steps.
    let slow = prop_oneof![20 => Just(STEP), 1 => STEP + 1..3 * STEP];
    let fast = prop_oneof![20 => Just(STEP / 3), 1 => 1..2 * STEP];
    let frames = |later| prop::collection::vec((later, crowd.clone()), 1..80);
    prop_oneof![frames(slow.boxed()), frames(fast.boxed())].prop_map(|frames| {
        let mut frame = -3 * STEP;
        frames
            .into_iter()
            .map(|(later, crowd)| {
                frame += later;
                let ids = (0..).map(PedestrianId);
                let here = |(id, place): (PedestrianId, Option<Position>)| Some((id, place?));
                (frame, ids.zip(crowd).filter_map(here).collect())
            })
            .collect()
    })
}

fn recording(frames: &[(i64, People)]) -> Option<Recording> {
    let rows = frames.iter().flat_map(|(frame, people)| {
        people
            .iter()
            .map(|&(id, place)| Observation::new(*frame, id, place))
    });
    Recording::new("live", STEP, rows.collect()).ok()
}

/// Frames that must be refused after `last`.
fn refused(last: i64, someone: PedestrianId) -> [(i64, People, LiveError); 5] {
    let (frame, here, nowhere) = (last + STEP, [1.0, 2.0], [f64::INFINITY, 0.0]);
    let too_early = |frame| LiveError::TooEarly { frame, last };
    let duplicate = LiveError::Duplicate {
        pedestrian: someone,
        frame,
    };
    let not_finite = LiveError::NotFinite {
        pedestrian: someone,
        frame,
        position: nowhere,
    };
    let far = i64::MIN;
    [
        (last, vec![], too_early(last)),
        (last - 1, vec![], too_early(last - 1)),
        (far, vec![], LiveError::FrameOutOfRange { frame: far }),
        (frame, vec![(someone, here), (someone, here)], duplicate),
        (frame, vec![(someone, nowhere)], not_finite),
    ]
}

proptest! {
    #[test]
    fn windows_are_those_of_the_whole_recording(frames in frames()) {
        let mut tracks = LiveTracks::with_frame_step(STEP).unwrap();
        let mut windows = Vec::new();
        for (frame, people) in &frames {
            windows.extend(tracks.push(*frame, people.iter().copied()).unwrap());
            prop_assert!(tracks.len() >= people.len());
        }
        let cut = recording(&frames).map_or(Vec::new(), |recording| cut_windows(&recording));
        prop_assert_eq!(windows, cut);
    }

    /// A refused frame is as one never pushed.
    #[test]
    fn errors_change_nothing(frames in frames(), someone in (0..6_i64).prop_map(PedestrianId)) {
        let mut tracks = LiveTracks::with_frame_step(STEP).unwrap();
        for (frame, people) in frames {
            tracks.push(frame, people).unwrap();
            let before = tracks.clone();
            for (frame, people, error) in refused(tracks.last_frame().unwrap(), someone) {
                prop_assert_eq!(tracks.push(frame, people), Err(error));
                prop_assert_eq!(&tracks, &before);
            }
        }
    }
}

/// Half of what the strategy draws must have windows, or the law above speaks of nothing.
#[test]
fn the_law_is_about_something() {
    use proptest::strategy::ValueTree as _;
    let mut runner = proptest::test_runner::TestRunner::deterministic();
    let with_windows = (0..200).filter(|_| {
        let frames = frames().new_tree(&mut runner).unwrap().current();
        recording(&frames).is_some_and(|recording| !cut_windows(&recording).is_empty())
    });
    let count = with_windows.count();
    assert!(count > 100, "{count} of 200");
}

#[test]
fn real_people_too() {
    let Some(dataset) = recordings::load(Convention::Star) else {
        return;
    };
    for recording in dataset.recordings() {
        let cut = cut_windows(recording);
        assert!(cut.len() > 100, "{}", recording.name());
        assert_eq!(live_windows(recording), cut, "{}", recording.name());
    }
}

/// People come and go for 40,000 frames, more than four hours, each with an id of their own: who left is forgotten at once, with holes to fill a
/// little later.
#[test]
fn nobody_is_remembered_who_left() {
    for (completion, most) in [(Completion::NONE, 10), (Completion::USUAL, 12)] {
        let mut tracks = LiveTracks::new().completing(completion);
        let mut windows = 0_usize;
        for frame in 0..40_000_i64 {
            // ten at a time, each for ten frames
            let present = (0..10).map(|k| (frame - k) / 10 * 10 + k);
            let people = present.map(|id| (PedestrianId(id), [frame as f64, id as f64]));
            windows += usize::from(tracks.push(frame, people).unwrap().is_some());
            let known = tracks.len();
            assert!((10..=most).contains(&known), "frame {frame}: {known}");
        }
        assert!(windows > 39_000, "{windows}");
        assert_eq!(tracks.push(40_000, []), Ok(None));
        assert_eq!(tracks.is_empty(), completion == Completion::NONE);
    }
}

/// The first frames and a gap by hand.
#[test]
fn a_gap_starts_everybody_anew() {
    let one = |x: f64| [(PedestrianId(1), [x, 0.0])];
    let mut tracks = LiveTracks::new();
    let lengths = |tracks: &mut LiveTracks, from: i64, count: i64| -> Vec<bool> {
        let pushed = (from..from + count).map(|t| tracks.push(t, one(t as f64)));
        pushed.map(|window| window.unwrap().is_some()).collect()
    };
    let mut expected = vec![false; OBSERVED - 1];
    expected.extend([true, true]);
    assert_eq!(lengths(&mut tracks, 0, 9), expected);
    assert_eq!(lengths(&mut tracks, 10, 9), expected); // frame 9 is missing
    assert_eq!(tracks.window().unwrap().frames()[0], 11);
}

#[test]
fn a_step_of_nothing_is_refused() {
    for found in [0, -1, (1 << 31) + 1] {
        let error = LiveTracks::with_frame_step(found);
        assert_eq!(error, Err(LiveError::FrameStep { found }));
    }
}

/// A frame far ahead by mistake, or a tracker that counts from 0 again.
#[test]
fn what_was_cleared_starts_anew() {
    let one = || [(PedestrianId(1), [0.0, 0.0])];
    let mut tracks = LiveTracks::new();
    tracks.push(1 << 52, one()).unwrap();
    let error = tracks.push(0, one()).unwrap_err();
    assert!(error.to_string().contains("clear"), "{error}");
    tracks.clear();
    assert_eq!((tracks.len(), tracks.last_frame()), (0, None));
    for frame in 0..7 {
        assert!(tracks.push(frame, one()).unwrap().is_none());
    }
    assert!(tracks.push(7, one()).unwrap().is_some());
}

/// As far as frames go, and steps.
#[test]
fn at_the_ends_of_time() {
    let step = 1 << 31;
    let mut tracks = LiveTracks::with_frame_step(step)
        .unwrap()
        .completing(Completion::USUAL);
    let (first, last) = (1 - (1 << 53), (1 << 53) - 1);
    for frame in [first, first + step, last - 2 * step, last] {
        let one = [(PedestrianId(1), [0.0, 1e308])];
        let window = tracks.push(frame, one).unwrap();
        assert_eq!(window.is_some(), frame == first + step || frame == last);
    }
    // the velocity of these is no number
    let mut tracks = LiveTracks::new().completing(Completion::USUAL);
    for (frame, x) in [(0, -1e308), (1, 1e308)] {
        assert_eq!(tracks.push(frame, [(PedestrianId(1), [x, 0.0])]), Ok(None));
    }
}
