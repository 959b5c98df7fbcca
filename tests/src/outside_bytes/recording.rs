//! What holds of every file of tracks, whatever its format.

use ddl_data::{Format, Observation, Recording, parse_recording};

/// Reads bytes as a file of tracks. What is read keeps its bounds and, written again in the same format, with its rows the other way
/// round, reads the same.
pub(super) fn check(bytes: &[u8], format: Format, written: fn(&[Observation]) -> String) {
    let recording = match parse_recording(bytes, "fuzzed", format) {
        Ok(recording) => recording,
        Err(error) => {
            assert!(error.to_string().contains("fuzzed"), "{error}");
            return;
        }
    };
    bounded(&recording);
    // The rows below are written with numbers; words have tests of their own in `ddl-data`.
    if recording
        .observations()
        .iter()
        .any(|seen| seen.pedestrian.0 >= 1 << 53)
    {
        return;
    }
    let mut rows = recording.observations().to_vec();
    rows.reverse();
    // the format's rate is no part of its rows
    let rate = recording
        .rate()
        .map(|fps| format!("{{\"scene\": {{\"fps\": {fps}}}}}\n"));
    let text = rate.unwrap_or_default() + &written(&rows);
    let again = parse_recording(text.as_bytes(), "fuzzed", format)
        .unwrap_or_else(|error| panic!("what was read is refused when written: {error}\n{text}"));
    assert_eq!(again, recording, "{text}");
}

/// Whoever reads tracks may count on these bounds.
pub(super) fn bounded(recording: &Recording) {
    for seen in recording.observations() {
        assert!(
            seen.position
                .iter()
                .all(|c| c.abs() <= ddl_data::COORDINATE_LIMIT),
            "{seen:?} is farther away than anybody walks"
        );
        assert!(seen.frame.unsigned_abs() < 1 << 53, "{seen:?}");
    }
}

/// Rows of a table, each by `row`.
pub(super) fn lines(rows: &[Observation], row: impl Fn(&Observation) -> String) -> String {
    rows.iter().map(|seen| row(seen) + "\n").collect()
}
