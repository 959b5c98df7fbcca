//! Tracks fed frame by frame: refused frames, and forgotten pedestrians.

use ddl_core::PedestrianId;
use ddl_data::{Clock, ClockError, Completeness, LiveError, LiveTracks, Observation, Recording, RecordingError};
use proptest::prelude::*;
use rand::SeedableRng as _;
use rand_chacha::ChaCha8Rng;

#[test]
fn errors_change_nothing() {
    let (pedestrian, here, position) = (PedestrianId(3), [1.0, 2.0], [1.1e7, 0.0]);
    let mut tracks = LiveTracks::with_frame_step(6).unwrap();
    for last in 0..20 {
        tracks.push(last, [(pedestrian, here)]).unwrap();
        let before = tracks.clone();
        let (frame, far) = (last + 6, i64::MIN);
        let too_early = |frame| LiveError::TooEarly { frame, last };
        let too_far = LiveError::NoPosition { pedestrian, frame, position };
        let twice = vec![(pedestrian, here); 2];
        for (frame, pedestrians, error) in [
            (last, vec![], too_early(last)),
            (last - 1, vec![], too_early(last - 1)),
            (far, vec![], LiveError::FrameOutOfRange { frame: far }),
            (frame, twice, LiveError::Duplicate { pedestrian, frame }),
            (frame, vec![(pedestrian, position)], too_far),
        ] {
            assert_eq!(tracks.push(frame, pedestrians), Err(error));
            assert_eq!(tracks, before);
        }
    }
    let recording = Recording::in_usual_step("far", vec![Observation::new(0, pedestrian, position)]);
    assert!(matches!(recording, Err(RecordingError::Row(LiveError::NoPosition { .. }))));
    for step in [0, -1, (1 << 31) + 1] {
        assert_eq!(LiveTracks::with_frame_step(step), Err(ClockError::FrameStep { found: step }));
    }
}

/// A frame far ahead by mistake, or a tracker that restarts at 0.
#[test]
fn cleared_tracks_accept_any_frame() {
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

/// Whatever a stream claims, what is kept of it is bounded.
#[test]
fn no_more_pedestrians_are_kept_than_a_crowd_has() {
    let mut tracks = LiveTracks::with_frame_step(4).unwrap();
    let crowd = |first: i64, count: i64| (first..first + count).map(|id| (PedestrianId(id), [0.0, 0.0]));
    tracks.push(0, crowd(0, 100_000)).unwrap();
    tracks.push(1, crowd(100_000, 100_000)).unwrap();
    let error = tracks.push(2, crowd(200_000, 1)).unwrap_err();
    assert!(matches!(error, LiveError::TooManyPedestrians { limit: 200_000 }), "{error}");
    // Those who were there stay, and others may come when they have left.
    tracks.push(2, crowd(0, 100_000)).unwrap();
    tracks.push(22, crowd(200_000, 100_000)).unwrap();
    assert_eq!(tracks.len(), 200_000);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    /// What is observed of somebody does not depend on how exactly others are.
    #[test]
    fn the_noise_of_others_changes_nothing(seed in any::<u64>(), others in 1..6_i64, rows in 1..40_i64) {
        let observed = |others: i64| {
            let mut random = ChaCha8Rng::seed_from_u64(seed);
            let mut tracks = LiveTracks::with_clock(Clock::with_frame_time(0.1).unwrap())
                .with_completeness(Completeness::Partial);
            let mut last = None;
            for frame in 0..rows {
                let mut near = |place: f64, noise: f64| [0, 1].map(|_| place + noise * (random.random::<f64>() - 0.5));
                let own = (PedestrianId(3), near(0.05 * frame as f64, 0.02));
                let rest: Vec<_> = (0..others).map(|i| (PedestrianId(10 + i), near(1000.0, 1.0))).collect();
                random = ChaCha8Rng::seed_from_u64(seed.wrapping_add(frame as u64));
                last = tracks.push(frame, [own].into_iter().chain(rest)).unwrap();
            }
            let window = last.unwrap();
            let i = window.pedestrians().iter().position(|id| id.0 == 3).unwrap();
            (window.observed(i).to_vec(), window.quality(i), window.other(i).copied())
        };
        prop_assert_eq!(observed(0), observed(others));
    }
}
