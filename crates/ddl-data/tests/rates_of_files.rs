//! The rate that scenes of TrajNet++ files say.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use ddl_data::{Format, parse_recording};

fn complaint(text: impl AsRef<[u8]>) -> String {
    parse_recording(text.as_ref(), "f", Format::TrajNet)
        .unwrap_err()
        .to_string()
}

/// Somebody who walks 1.3 m/s, seen twice a second, every 12 frame numbers.
fn trajnet_at_2_fps(scenes: &str) -> String {
    let track = |t: u32| {
        let x = 0.65 * f64::from(t);
        format!(
            "{{\"track\": {{\"f\": {}, \"p\": 1, \"x\": {x}, \"y\": 0}}}}\n",
            12 * t
        )
    };
    scenes.to_owned() + &(0..30).map(track).collect::<String>()
}

#[test]
fn scenes_of_trajnet_say_how_fast_their_frames_follow() {
    let scene =
        |fps: &str| format!("{{\"scene\": {{\"id\": 0, \"p\": 1, \"s\": 0, \"e\": 240{fps}}}}}\n");
    let read = |scenes: &str| {
        parse_recording(trajnet_at_2_fps(scenes).as_bytes(), "f", Format::TrajNet).unwrap()
    };
    let rate = |scenes: &str| read(scenes).rate();
    assert_eq!(rate(""), None);
    assert_eq!(rate(&scene("")), None);
    assert_eq!(rate(&scene(r#", "fps": null"#)), None);
    let two = scene(r#", "fps": 2"#);
    assert_eq!(
        rate(&(scene("") + &two + &scene(r#", "fps": 2.0"#))),
        Some(2.0)
    );

    // 24 frame numbers a second, 9.6 in 0.4 s
    let recording = read(&two);
    let frame_time = recording.frame_time_told().unwrap();
    assert!((frame_time - 1.0 / 24.0).abs() < 1e-12, "{frame_time}");
    let steps = recording.in_steps(frame_time).unwrap();
    assert!(steps.resampled);
    let median = steps.recording.summary().median_speed.unwrap();
    assert!((median - 1.3).abs() < 1e-9, "{median}");

    // the usual files, whose frames are 0.4 s apart whatever their numbers, are left as they are
    let usual = read(&scene(r#", "fps": 2.5"#));
    let steps = usual.in_steps(usual.frame_time_told().unwrap()).unwrap();
    assert_eq!((steps.recording, steps.resampled), (usual, false));
}

#[test]
fn scenes_that_disagree_about_the_rate_are_named() {
    let scenes =
        "{\"scene\": {\"id\": 0, \"fps\": 2.5}}\n\n{\"scene\": {\"id\": 1, \"fps\": 25}}\n";
    let told = complaint(trajnet_at_2_fps(scenes));
    assert!(
        told.starts_with(
            "f, line 3: scene.fps is 25, but 2.5 on line 1; a file is of one recording"
        ),
        "{told}"
    );
    for fps in ["0", "-2.5", "\"fast\"", "[2.5]"] {
        let scenes = format!("{{\"scene\": {{\"id\": 0, \"fps\": {fps}}}}}\n");
        let told = complaint(trajnet_at_2_fps(&scenes));
        let expected = format!(
            "f, line 1: scene.fps must be a number above 0, the frames in a second, found {fps}"
        );
        assert_eq!(told, expected);
    }
}
