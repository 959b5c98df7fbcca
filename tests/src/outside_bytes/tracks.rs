//! Files of tracks in every format. Recordings keep their bounds and, written as TrajNet++ ndjson, are read back
//! unchanged.

use ddl_data::{Format, Observation, Position, Recording, parse_recording};
use std::fmt::Write as _;

/// Reads a file of tracks in a format.
pub(super) fn check(bytes: &[u8], format: Format) {
    let recording = match parse_recording(bytes, "fuzzed", format) {
        Ok(recording) => recording,
        Err(error) => {
            assert!(error.to_string().contains("fuzzed"), "{error}");
            return;
        }
    };
    bounded(&recording);
    // The rows below are written with numbers; words are tested in `ddl-data`.
    if recording.observations().iter().any(|seen| seen.pedestrian.0 >= 1 << 53) {
        return;
    }
    let mut text = String::new();
    if let Some(fps) = recording.rate() {
        let _ = writeln!(text, "{{\"scene\": {{\"fps\": {fps}}}}}"); // writing to a string cannot fail
    }
    // In reverse order.
    for &Observation {
        frame,
        pedestrian,
        position: [x, y],
        ..
    } in recording.observations().iter().rev()
    {
        let _ = writeln!(
            text,
            "{{\"track\": {{\"y\": {y:?}, \"x\": {x:?}, \"p\": {pedestrian}, \"f\": {frame}}}}}"
        );
    }
    let again = parse_recording(text.as_bytes(), "fuzzed", Format::TrajNet)
        .unwrap_or_else(|error| panic!("a written recording is refused: {error}\n{text}"));
    assert_eq!(again.observations(), recording.observations(), "{text}");
    if recording.time_unit().is_some() {
        return;
    }
    assert_eq!(
        (again.frame_step(), again.rate()),
        (recording.frame_step(), recording.rate()),
        "{text}"
    );
}

/// The bounds that callers of the readers rely on.
pub(super) fn bounded(recording: &Recording) {
    for seen in recording.observations() {
        let is_near = |position: Position| position.iter().all(|c| c.abs() <= ddl_data::COORDINATE_LIMIT);
        assert!(is_near(seen.position), "{seen:?} is beyond the coordinate limit");
        assert!(seen.frame.unsigned_abs() < 1 << 53, "{seen:?}");
    }
}
