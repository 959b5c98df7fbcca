//! A session with a memory of its place.

use ddl::data::{LiveTracks, Recording, Window};
use ddl::memory::{Playback, SceneMemory};
use ddl::{Request, Session, SessionMemory, Variant};
use ddl_tests::{bits, crowd, drawn_model};

#[test]
fn live_forecasts_agree_with_a_replay_of_the_recording() {
    let model = drawn_model::of(Variant::Full);
    let whole = crowd::dataset().recording("corridor").unwrap();
    let (step, end) = (whole.frame_step(), whole.frames()[60]);
    // Every frame lacks some pedestrians, and one frame is missing.
    let is_seen = |&at: &i64, id: i64| at < end && at != whole.frames()[30] && (at / step + id) % 11 != 0;
    let seen = whole.observations().iter();
    let seen = seen.filter(|seen| is_seen(&seen.frame, seen.pedestrian.0));
    let recording = Recording::new("live", step, seen.copied().collect()).unwrap();
    let seen_rows = recording.observations().len();
    let memory = SceneMemory::new(step, SceneMemory::DEFAULT_CAPACITY).unwrap();
    // A row that is doubted when it comes is not stored: somebody starts at once.
    let mut tracks = LiveTracks::with_frame_step(step).unwrap();
    let mut believed = Vec::new();
    for &frame in recording.frames() {
        let rows = recording.at(frame);
        tracks.push(frame, rows.iter().map(|seen| (seen.pedestrian, seen.position))).unwrap();
        believed.extend(rows.iter().filter(|seen| !tracks.has_left_out(seen.pedestrian)).copied());
    }
    assert!(believed.len() < seen_rows && believed.len() > seen_rows - 5, "{} of {seen_rows}", believed.len());
    let believed = Recording::new("believed", step, believed).unwrap();
    let replayed = memory.replay(&believed, Playback::Forward, recording.observed_windows(), 12);
    let mut replayed = replayed.unwrap().into_iter();
    let session = |request| {
        let session = Session::new(&model, LiveTracks::with_frame_step(step).unwrap(), request).unwrap();
        session.remembering(SessionMemory::Kept).unwrap()
    };
    let mut live = session(Request::default());
    let mut certified = session(Request::default().with_certificates());
    let remembers = |window: &Window| (0..window.len()).any(|i| !window.remembered(i).is_empty());
    let (mut remembering, mut changed) = (0, 0);
    for &frame in recording.frames() {
        let seen = recording.at(frame).iter().map(|seen| (seen.pedestrian, seen.position));
        let evidence = certified.push(frame, seen.clone()).unwrap().answer;
        let now = live.push(frame, seen).unwrap().answer;
        assert_eq!(now.is_some(), evidence.is_some(), "frame {frame}");
        let Some(((observed, now), (_, evidence))) = now.zip(evidence) else {
            continue;
        };
        let window = replayed.next().unwrap();
        assert!(observed == window, "frame {frame}");
        let asked = |request: &Request, window: &Window| {
            model.forecast(std::slice::from_ref(window), request).unwrap().remove(0)
        };
        assert_eq!(bits::of(now.forecast()), bits::of(asked(&Request::default(), &window).forecast()));
        assert_eq!(bits::of(evidence.forecast()), bits::of(now.forecast()));
        let expected = asked(&Request::default().with_certificates(), &window);
        assert_eq!(evidence.certificates(), expected.certificates());
        remembering += usize::from(remembers(&window));
        let forgetful = asked(&Request::default(), &window.with_remembered(|_| Vec::new()));
        changed += usize::from(bits::of(forgetful.forecast()) != bits::of(now.forecast()));
    }
    assert!(replayed.next().is_none());
    assert!(remembering > 20 && changed == remembering, "{changed} of {remembering}");
    assert!(live.place(None).unwrap().memory().segments() > 100);
}
