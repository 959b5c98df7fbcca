//! A live forecaster with a memory of its place.

use ddl::data::{LiveTracks, Recording, Window};
use ddl::memory::{Playback, SceneMemory};
use ddl::{Forecaster as _, LiveForecaster, Variant};
use ddl_tests::{bits, crowd, drawn_model};

#[test]
fn live_forecasts_agree_with_a_replay_of_the_recording() {
    let model = drawn_model::of(Variant::Full);
    let whole = crowd::dataset().recording("corridor").unwrap();
    let (step, end) = (whole.frame_step(), whole.frames()[60]);
    let seen = whole.observations().iter().filter(|seen| seen.frame < end);
    let recording = Recording::new("live", step, seen.copied().collect()).unwrap();
    let memory = SceneMemory::new(step, SceneMemory::DEFAULT_CAPACITY).unwrap();
    let replayed = memory.replay(&recording, Playback::Forward, recording.observed_windows(), 12);
    let mut replayed = replayed.unwrap().into_iter();
    let live = LiveForecaster::with_tracks(&model, LiveTracks::with_frame_step(step).unwrap());
    let mut live = live.remembering(None).unwrap();
    let remembers = |window: &Window| (0..window.len()).any(|i| !window.remembered(i).is_empty());
    let (mut remembering, mut changed) = (0, 0);
    for &frame in recording.frames() {
        let seen = recording.at(frame).iter().map(|seen| (seen.pedestrian, seen.position));
        let Some(now) = live.push(frame, seen).unwrap() else {
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
