//! Recordings at other frame rates.

use ddl_data::{Format, Observation, PedestrianId, RateError, Recording, ResampledRecording, parse_recording};
use proptest::prelude::*;

use crate::readers::complaint;

/// Two pedestrians that walk straight on, seen at every `spacing`-th frame of the given ones.
fn pedestrians(frames: impl Iterator<Item = i64>, spacing: i64) -> Recording {
    let place = |id: i64, frame: i64| [0.05 * frame as f64 + id as f64, -0.02 * frame as f64];
    let seen = frames.flat_map(|frame| [1, 2].map(|id| Observation::new(frame, PedestrianId(id), place(id, frame))));
    Recording::new("film", spacing, seen.collect()).unwrap()
}

fn step_seconds(steps: &ResampledRecording, rate: f64) -> f64 {
    steps.recording.frame_step() as f64 / rate / steps.parts as f64
}

/// Recordings whose step is a whole number of frames are unchanged; others are counted in parts of a frame. By hand: 12
/// frames per second are 4.8 per step, 4 per second 1.6, 1 per second 0.4. At 25 per second, every third frame seen,
/// the 10 frames of a step are not a multiple of 3.
#[test]
fn a_step_is_a_whole_number_of_frames_or_of_their_parts() {
    for (rate, spacing, parts, step, resampled) in [
        (25.0, 1, 1, 10, false),
        (29.97, 1, 1, 12, false),
        (1000.0, 100, 1, 400, false),
        (12.0, 1, 5, 24, true),
        (1.0, 1, 5, 2, true),
        (25.0, 3, 1, 10, true),
        (7.0, 1, 5, 14, true),
    ] {
        let recording = pedestrians((0..50).map(|t| t * spacing), spacing);
        let steps = recording.resampled_to_steps(1.0 / rate).unwrap();
        assert_eq!((steps.parts, steps.resampled), (parts, resampled), "{rate}");
        assert_eq!(steps.recording.frame_step(), step, "{rate}");
        let last = 49 * spacing * parts;
        assert_eq!(steps.recording.frames().last(), Some(&last), "{rate}");
        let same = steps.recording.observations() == recording.observations();
        assert_eq!(same, !resampled, "{rate}");
        assert!((step_seconds(&steps, rate) - 0.4).abs() < 0.002);
    }
}

/// One late frame changes two of 40 differences, 5 %; two late frames change four.
#[test]
fn a_few_late_frames_are_left_alone() {
    let late = |late: &'static [i64]| {
        let frames = (0..41_i64).map(|t| 3 + 5 * t + i64::from(late.contains(&t)));
        pedestrians(frames, 5).resampled_to_steps(0.04).unwrap().resampled
    };
    assert!(!late(&[20]));
    assert!(late(&[10, 30]));
}

#[test]
fn a_hole_stays_a_hole() {
    // 24 frames per second, frames 30 to 59 missing: more than a second.
    let seen = (0..30).chain(60..100);
    let steps = pedestrians(seen, 1).resampled_to_steps(1.0 / 24.0).unwrap();
    let frames = steps.recording.frames();
    let missing = |frame: &&i64| (29 * 5 + 1..60 * 5).contains(*frame);
    assert_eq!(frames.iter().find(missing), None);
    assert!(frames.iter().any(|frame| *frame < 30 * 5));
}

#[test]
fn invalid_rates_are_refused() {
    let recording = pedestrians(0..20, 1);
    for time in [0.0, -0.1, f64::NAN, f64::INFINITY, 1e-12] {
        let error = recording.resampled_to_steps(time).unwrap_err();
        assert!(matches!(error, RateError::FrameTime { .. }), "{time}");
    }
    assert_eq!(
        recording.resampled_to_steps(1.5),
        Err(RateError::TooSlow { apart: 1.5 })
    );
    let far = pedestrians((1 << 52)..(1 << 52) + 20, 1);
    let error = far.resampled_to_steps(1.0 / 24.0).unwrap_err();
    assert!(matches!(error, RateError::Frames { .. }), "{error}");
}

proptest! {
    #[test]
    fn uniform_motion_stays_uniform(
        rate in 1.0..60.0_f64,
        spacing in 1..4_i64,
        first in -1000..1000_i64,
        count in 2..60_i64,
    ) {
        let recording = pedestrians((0..count).map(|t| first + t * spacing), spacing);
        let Ok(steps) = recording.resampled_to_steps(1.0 / rate) else {
            prop_assert!(spacing as f64 / rate > 1.2);
            return Ok(());
        };
        let parts = steps.parts as f64;
        prop_assert!((step_seconds(&steps, rate) / 0.4 - 1.0).abs() <= 0.005 + 1e-9);
        for seen in steps.recording.observations() {
            let (frame, id) = (seen.frame as f64 / parts, seen.pedestrian.0 as f64);
            let [x, y] = seen.position;
            prop_assert!((x - 0.05 * frame - id).abs() < 1e-9 && (y + 0.02 * frame).abs() < 1e-9);
            prop_assert!(frame >= first as f64);
        }
        if steps.resampled {
            let frames = steps.recording.frames();
            let last = (first + (count - 1) * spacing) * steps.parts;
            prop_assert_eq!(frames.last(), Some(&last));
            let step = steps.recording.frame_step();
            prop_assert!(frames.windows(2).all(|pair| pair[1] - pair[0] == step));
            prop_assert!(frames[0] - first * steps.parts < step);
        }
    }
}

/// A millisecond clock that jitters by 1 ms: no two observations are exactly 0.4 s apart.
#[test]
fn a_jittering_clock_is_resampled() {
    let frames = (0..60_i64).map(|t| 40 * t + [0, 1, -1, 0, 1][(t % 5) as usize]);
    let steps = pedestrians(frames, 40).resampled_to_steps(0.001).unwrap();
    assert_eq!((steps.parts, steps.resampled), (1, true));
    let recording = &steps.recording;
    assert_eq!(recording.frame_step(), 400);
    let windows = recording.observed_windows();
    assert!(windows.is_empty(), "2.4 s are too short for an observation");
    for seen in recording.observations() {
        let [x, _] = seen.position;
        assert!((x - 0.05 * seen.frame as f64 - seen.pedestrian.0 as f64).abs() < 1e-9);
    }
    assert_eq!(recording.frames().len(), 6);
}

/// A pedestrian at 1.3 m/s, seen twice per second, every 12 frame numbers.
fn trajnet_at_2_fps(scenes: &str) -> String {
    let track = |t: u32| {
        let x = 0.65 * f64::from(t);
        format!("{{\"track\": {{\"f\": {}, \"p\": 1, \"x\": {x}, \"y\": 0}}}}\n", 12 * t)
    };
    scenes.to_owned() + &(0..30).map(track).collect::<String>()
}

#[test]
fn scenes_of_trajnet_state_the_frame_rate() {
    let scene = |fps: &str| format!("{{\"scene\": {{\"id\": 0, \"p\": 1, \"s\": 0, \"e\": 240{fps}}}}}\n");
    let read = |scenes: &str| parse_recording(trajnet_at_2_fps(scenes).as_bytes(), "f", Format::TrajNet).unwrap();
    let rate = |scenes: &str| read(scenes).rate();
    assert_eq!(rate(""), None);
    assert_eq!(rate(&scene("")), None);
    assert_eq!(rate(&scene(r#", "fps": null"#)), None);
    let two = scene(r#", "fps": 2"#);
    assert_eq!(rate(&(scene("") + &two + &scene(r#", "fps": 2.0"#))), Some(2.0));

    // 24 frame numbers per second, 9.6 in 0.4 s.
    let recording = read(&two);
    let frame_time = recording.stated_frame_time().unwrap();
    assert!((frame_time - 1.0 / 24.0).abs() < 1e-12, "{frame_time}");
    let steps = recording.resampled_to_steps(frame_time).unwrap();
    assert!(steps.resampled);
    let median = steps.recording.summary().median_speed.unwrap();
    assert!((median - 1.3).abs() < 1e-9, "{median}");

    // The usual files, with frames 0.4 s apart and any frame numbers, are left unchanged.
    let usual = read(&scene(r#", "fps": 2.5"#));
    let steps = usual.resampled_to_steps(usual.stated_frame_time().unwrap()).unwrap();
    assert_eq!((steps.recording, steps.resampled), (usual, false));
}

#[test]
fn scenes_that_disagree_about_the_rate_are_named() {
    let scenes = "{\"scene\": {\"id\": 0, \"fps\": 2.5}}\n\n{\"scene\": {\"id\": 1, \"fps\": 25}}\n";
    let message = complaint(trajnet_at_2_fps(scenes), Format::TrajNet);
    assert!(
        message.starts_with("f, line 3: scene.fps is 25, but 2.5 on line 1; a file holds one recording"),
        "{message}"
    );
    for fps in ["0", "-2.5", "\"fast\"", "[2.5]"] {
        let scenes = format!("{{\"scene\": {{\"id\": 0, \"fps\": {fps}}}}}\n");
        let message = complaint(trajnet_at_2_fps(&scenes), Format::TrajNet);
        let expected = format!("f, line 1: scene.fps must be a number above 0, the frames in a second, found {fps}");
        assert_eq!(message, expected);
    }
}
