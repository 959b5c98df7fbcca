//! Files of tracks in every format. Recordings keep their bounds and, written as TrajNet++ ndjson, are read back
//! unchanged.

use super::valid_file::names_file;
use ddl_core::Position;
use ddl_data::{Format, Observation, Recording, parse_recording, write_recording};

/// Reads a file of tracks in a format.
pub(super) fn check(bytes: &[u8], format: Format) {
    let recording = match parse_recording(bytes, "fuzzed", format) {
        Ok(recording) => recording,
        Err(error) => return names_file(&error, "fuzzed"),
    };
    bounded(&recording);
    // Words and times are tested in `ddl-data`.
    let is_word = |seen: &Observation| seen.pedestrian.0 >= 1 << 53;
    if recording.observations().iter().any(is_word) || recording.time_unit().is_some() {
        return;
    }
    let written = write_recording(&recording, Format::TrajNet).and_then(|mut text| {
        let mut lines: Vec<&[u8]> = text.split_inclusive(|&byte| byte == b'\n').collect();
        lines.reverse();
        text = lines.concat();
        parse_recording(&text, "written", Format::TrajNet)
    });
    let again = written.unwrap_or_else(|error| panic!("a written recording is refused: {error}"));
    assert_eq!(again.observations(), recording.observations());
    assert_eq!(again.frame_step(), recording.frame_step());
}

/// The bounds that callers of the readers rely on.
pub(super) fn bounded(recording: &Recording) {
    for seen in recording.observations() {
        let is_near = |position: Position| position.iter().all(|c| c.abs() <= ddl_core::COORDINATE_LIMIT);
        assert!(is_near(seen.position), "{seen:?} is beyond the coordinate limit");
        assert!(seen.frame.unsigned_abs() < 1 << 53, "{seen:?}");
    }
}
