//! Clocks: how frame numbers and times count, and how they print back.

use ddl_core::PedestrianId;
use ddl_data::{Clock, ClockError, Format, FrameReader, LiveTracks, Observation, Recording, TimeUnit, parse_recording};
use proptest::prelude::*;

/// By hand: 12 frames a second are 4.8 in a step, 4 are 1.6, 1 is 0.4.
#[test]
fn a_step_is_a_whole_number_of_frames_or_of_their_parts() {
    for (rate, ticks, step) in [
        (2.5, 1, 1),
        (5.0, 1, 2),
        (12.5, 1, 5),
        (25.0, 1, 10),
        (29.97, 1, 12),
        (1000.0, 1, 400),
        (12.0, 5, 24),
        (4.0, 5, 8),
        (1.0, 5, 2),
        (7.0, 5, 14),
        (9.0, 5, 18),
        (23.976, 22, 211),
    ] {
        let clock = Clock::with_frame_time(1.0 / rate).unwrap();
        assert_eq!((clock.tick(1), clock.frame_step()), (Ok(ticks), step), "{rate}");
        assert_eq!(clock.counts_frames(), ticks == 1);
    }
}

proptest! {
    /// Within 0.5 % where a tick is a frame, else within 0.01 % or a thousandth of a frame.
    #[test]
    fn a_step_takes_two_fifths_of_a_second(rate in (0.0..5.0_f64).prop_map(|power| 0.01 * 10_f64.powf(power)),
                                           frame in -1_000_000_000..1_000_000_000_i64) {
        let clock = Clock::with_frame_time(1.0 / rate).unwrap();
        let ticks = clock.tick(1).unwrap();
        let off = (clock.frame_step() as f64 / (ticks as f64 * rate * 0.4) - 1.0).abs();
        let rounded = 0.5 / (1000.0 * rate * 0.4);
        prop_assert!(off <= if ticks == 1 { 0.005 } else { f64::max(1e-4, rounded) } + 1e-12, "{clock:?} {off}");
        let tick = clock.tick(frame).unwrap();
        prop_assert_eq!(tick, frame * ticks);
        prop_assert_eq!(clock.words(tick), format!("frame {frame}"));
        let next: f64 = clock.number(tick + 1).to_string().parse().unwrap();
        prop_assert!((next - frame as f64 - 1.0 / ticks as f64).abs() < 1e-6);
    }
}

#[test]
fn invalid_clocks_and_extreme_frames_are_refused() {
    for seconds in [0.0, -0.1, f64::NAN, f64::INFINITY, 1e-12, 400.1] {
        assert!(matches!(Clock::with_frame_time(seconds), Err(ClockError::FrameTime { .. })), "{seconds}");
    }
    assert!(Clock::with_frame_time(400.0).is_ok());
    for found in [0, -1, (1 << 31) + 1] {
        assert_eq!(Clock::with_frame_step(found), Err(ClockError::FrameStep { found }));
    }
    let (whole, parts) = (Clock::with_frame_time(0.04).unwrap(), Clock::with_frame_time(1.0 / 24.0).unwrap());
    for frame in [1 << 52, -(1 << 52), i64::MIN, i64::MAX] {
        assert_eq!(parts.tick(frame), Err(ClockError::Frame { frame, ticks: 5 }));
        assert_eq!(whole.tick(frame), Ok(frame)); // refused where it is used
        assert_eq!(whole.number(frame).to_string(), frame.to_string());
        assert!(LiveTracks::with_clock(parts).push(frame, []).is_err());
    }
}

fn pedestrian(frames: impl Iterator<Item = i64>) -> Recording {
    let seen = frames.map(|frame| Observation::new(frame, PedestrianId(1), [0.05 * frame as f64 % 1e6, 0.0]));
    Recording::in_usual_step("film", seen.collect()).unwrap()
}

#[test]
fn a_recording_is_counted_in_ticks_unless_its_rows_are_too_far_apart() {
    let recording = pedestrian((0..20).map(|t| 3 * t));
    let at = |seconds: f64| recording.on_clock(Clock::with_frame_time(seconds).unwrap());
    let seven = at(1.0 / 7.0).unwrap();
    assert_eq!((seven.frames()[19], seven.observations()[19].frame, seven.frame_step()), (285, 285, 14));
    let positions = |recording: &Recording| recording.observations().iter().map(|row| row.position).collect::<Vec<_>>();
    assert_eq!(positions(&seven), positions(&recording));
    assert!(at(0.4).is_ok() && at(0.000_34).is_ok());
    assert!(matches!(at(0.000_33), Err(ClockError::TooFast { .. })));
    assert!(matches!(at(0.41), Err(ClockError::TooSlow { apart }) if apart > 1.2));
    let refused = pedestrian((1 << 52)..(1 << 52) + 20).on_clock(Clock::with_frame_time(1.0 / 24.0).unwrap());
    assert_eq!(refused, Err(ClockError::Frame { frame: 1 << 52, ticks: 5 }));
}

/// A pedestrian at 1.3 m/s, seen twice a second, every 12 frame numbers.
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
    for none in [String::new(), scene(""), scene(r#", "fps": null"#)] {
        assert_eq!((read(&none).rate(), read(&none).stated_clock()), (None, None));
    }
    let two = scene(r#", "fps": 2"#);
    assert_eq!(read(&(scene("") + &two + &scene(r#", "fps": 2.0"#))).rate(), Some(2.0));

    // Times have no rate.
    let timed = trajnet_at_2_fps(&two).replace("\"f\"", "\"t\"");
    let timed = parse_recording(timed.as_bytes(), "f", Format::TrajNet).unwrap();
    assert_eq!((timed.rate(), timed.time_unit()), (None, Some(TimeUnit::Seconds)));
    // 24 frame numbers a second, 9.6 in 0.4 s.
    let recording = read(&two);
    let clock = recording.stated_clock().unwrap().unwrap();
    assert_eq!((clock.tick(1), clock.frame_step()), (Ok(5), 48));
    let windows = recording.on_clock(clock).unwrap().observed_windows();
    let speed = |track: &[[f64; 2]]| (track[7][0] - track[0][0]) / 2.8;
    let speeds: Vec<f64> = windows.iter().map(|window| speed(window.observed(0))).collect();
    assert!(speeds.len() == 24 && speeds.iter().all(|speed| (speed - 1.3).abs() < 0.02), "{speeds:?}");

    // The usual files, with frames 0.4 s apart and any frame numbers, are left unchanged.
    let usual = read(&scene(r#", "fps": 2.5"#));
    assert_eq!(usual.on_clock(usual.stated_clock().unwrap().unwrap()), Ok(usual));
}

#[test]
fn times_are_exact_to_a_microsecond_and_print_back() {
    let (_, times) = include_str!("times.txt").split_once("\n\n").unwrap();
    for case in times.lines() {
        let [header, time, expected, printed] = case.split("=> ").map(str::trim).collect::<Vec<_>>()[..] else {
            panic!("{case}");
        };
        let rest = if header.contains(',') { ",7,0,0" } else { "" };
        let text = format!("{header}\n{time}{rest}\n").trim_start().to_owned();
        let format = Format::guess("".as_ref(), text.as_bytes(), &ddl_data::ColumnChoice::default()).unwrap();
        let recording = parse_recording(text.as_bytes(), "f", format).unwrap();
        assert_eq!(recording.frames()[0].to_string(), expected, "{case}");
        let clock = recording.stated_clock().unwrap().unwrap();
        assert_eq!((clock.frame_step(), clock.words(recording.frames()[0])), (400_000, printed.to_owned()));
        let mut stream = FrameReader::new(text.as_bytes(), "f");
        assert_eq!(stream.next_frame().unwrap().unwrap().number, recording.frames()[0], "{case}");
        assert_eq!(stream.time_unit(), recording.time_unit());
    }
    let whole = parse_recording(b"frame,pedestrian,x,y\n12.0,7,0,0\n", "f", Format::Table).unwrap();
    assert_eq!((whole.frames(), whole.time_unit()), (&[12][..], None));
    // One fraction shows that all are seconds.
    let seconds = parse_recording(b"frame,pedestrian,x,y\n12,7,0,0\n12.4,7,0,0\n", "f", Format::Table).unwrap();
    assert_eq!((seconds.frames(), seconds.time_unit()), (&[12_000_000, 12_400_000][..], Some(TimeUnit::Seconds)));
}

/// A mistake decides nothing about the lines after it.
#[test]
fn a_stream_goes_on_after_a_time_of_another_kind() {
    for (text, numbers) in [
        ("frame,pedestrian,x,y\n0,7,0,0\n0.5,7,0,0\n1,7,0,0\n", [0, 1]),
        (
            "time,pedestrian,x,y\nnoon,7,0,0\n1970-01-01T00:00:01Z,7,0,0\n1970-01-01T00:00:02Z,7,0,0\n",
            [1_000_000, 2_000_000],
        ),
    ] {
        let mut frames = FrameReader::new(text.as_bytes(), "f");
        let read = std::iter::from_fn(|| frames.next_frame().transpose());
        let read: Vec<i64> = read.filter_map(|frame| Some(frame.ok()?.number)).collect();
        assert_eq!(read, numbers, "{text}");
    }
}

/// By hand: at 7 frames a second a step of 2.8 frames has 14 ticks.
#[test]
fn a_tick_has_a_time() {
    let seven = Clock::with_frame_time(1.0 / 7.0).unwrap();
    assert_eq!([-14, 0, 15].map(|tick| seven.microseconds(tick)), [-400_000, 0, 428_571]);
    let stamps = Clock::with_stamps(TimeUnit::Dates);
    assert_eq!(stamps.microseconds(1_700_000_000_123_456), 1_700_000_000_123_456);
    let nearest = [seven.number(29), stamps.number(1_700_000_000_123_456)].map(ddl_data::FrameNumber::nearest);
    assert_eq!(nearest, [6, 1_700_000_000]);
}
