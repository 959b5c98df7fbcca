//! A live forecaster with a memory of its place.

use ddl::data::{LiveTracks, Observation, PedestrianId, Position, Recording, Window};
use ddl::memory::{Playback, SceneMemory};
use ddl::{DdlError, Forecaster as _, LiveForecaster, PlaceMemory, Variant};
use ddl_tests::{bits, crowd, drawn_model};

fn empty(recording: &Recording) -> SceneMemory {
    SceneMemory::new(recording.frame_step(), SceneMemory::DEFAULT_CAPACITY).unwrap()
}

fn tracks(recording: &Recording) -> LiveTracks {
    LiveTracks::with_frame_step(recording.frame_step()).unwrap()
}

fn pedestrians(recording: &Recording, frame: i64) -> Vec<(PedestrianId, Position)> {
    let seen = recording.at(frame).iter();
    seen.map(|seen| (seen.pedestrian, seen.position)).collect()
}

/// A recording of a simulated scene up to a step, shifted by a distance.
fn scene(name: &str, steps: usize, by: f64) -> Recording {
    let dataset = crowd::dataset();
    let whole = dataset.recording(name).unwrap();
    let frames = whole.frames().iter().take(steps);
    let seen = frames.flat_map(|&frame| whole.at(frame));
    let moved = seen.map(|seen| Observation {
        position: seen.position.map(|x| x + by),
        ..*seen
    });
    Recording::new("live", whole.frame_step(), moved.collect()).unwrap()
}

#[test]
fn live_forecasts_agree_with_a_replay_of_the_recording() {
    let model = drawn_model::of(Variant::Full);
    let recording = scene("corridor", 60, 0.0);
    let windows = recording.observed_windows();
    let replayed = empty(&recording).replay(&recording, Playback::Forward, windows, 12);
    let mut replayed = replayed.unwrap().into_iter();
    let live = LiveForecaster::with_tracks(&model, tracks(&recording));
    let mut live = live.remembering(None).unwrap();
    let remembers = |window: &Window| (0..window.len()).any(|i| !window.remembered(i).is_empty());
    let (mut remembering, mut changed) = (0, 0);
    for &frame in recording.frames() {
        let Some(now) = live.push(frame, pedestrians(&recording, frame)).unwrap() else {
            continue;
        };
        let window = replayed.next().unwrap();
        assert!(now.window == window, "frame {frame}");
        assert_eq!(bits::of(&now.forecast), bits::of(&model.forecast(&window).unwrap()));
        remembering += usize::from(remembers(&window));
        let forgetful = model.forecast(&window.with_remembered(|_| Vec::new()));
        changed += usize::from(bits::of(&forgetful.unwrap()) != bits::of(&now.forecast));
    }
    assert!(replayed.next().is_none());
    assert!(remembering > 20 && changed == remembering, "{changed} of {remembering}");
    assert!(live.place().unwrap().memory().segments() > 100);
}

#[test]
fn a_memory_of_another_place_is_refused() {
    let model = drawn_model::of(Variant::Full);
    let here = scene("corridor", 300, 0.0);
    let mut memory = empty(&here);
    memory.observe_recording(&here).unwrap();
    for (name, by, is_refused) in [("corridor", 0.0, false), ("plaza", 500.0, true)] {
        let watched = scene(name, 120, by);
        let live = LiveForecaster::with_tracks(&model, tracks(&watched));
        let mut live = live.remembering(Some(memory.clone())).unwrap();
        for &frame in watched.frames() {
            live.push(frame, pedestrians(&watched, frame)).unwrap();
        }
        let kept_memory = live.place().unwrap().memory();
        let refused = live.place().and_then(PlaceMemory::refused);
        assert_eq!(refused.is_some(), is_refused, "{name}: {refused:?}");
        // The memory holds the observed place, not the other one.
        let least = if is_refused { 1 } else { memory.segments() };
        assert!(kept_memory.segments() > least, "{name}");
        if let Some(other) = refused {
            assert!(other.contains("of another place"), "{other}");
            assert!(kept_memory.segments() < memory.segments());
            let [low, _] = kept_memory.summary().extent.unwrap();
            assert!(low[0] > 400.0);
        }
    }
}

#[test]
fn a_memory_of_another_rate_is_refused_at_once() {
    let model = drawn_model::of(Variant::Full);
    let recording = scene("corridor", 9, 0.0);
    let error = LiveForecaster::new(&model)
        .remembering(Some(empty(&recording)))
        .unwrap_err();
    assert!(
        matches!(error, DdlError::MemoryFrameStep { camera: 1, memory: 10 }),
        "{error}"
    );
}
