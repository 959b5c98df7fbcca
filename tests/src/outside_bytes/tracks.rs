//! Files of tracks in every format. Recordings keep their bounds and, written in the same format, are read back
//! unchanged.

use ddl_data::{Format, Observation, PedestrianId, Position, Recording, parse_recording};

/// The table format.
pub(super) fn table(bytes: &[u8]) {
    check(bytes, Format::Table, |rows| {
        let header = "y,frame,x,pedestrian\n".to_owned();
        header + &lines(rows, |f, p, [x, y]| format!("{y},{f},{x},{p}"))
    });
}

/// The four lines of the convention `star`.
pub(super) fn star_csv(bytes: &[u8]) {
    check(bytes, Format::StarCsv, |rows| {
        let column =
            |field: &dyn Fn(&Observation) -> String| rows.iter().map(field).collect::<Vec<_>>().join(",") + "\n";
        [
            column(&|seen| seen.frame.to_string()),
            column(&|seen| seen.pedestrian.to_string()),
            column(&|seen| seen.position[1].to_string()),
            column(&|seen| seen.position[0].to_string()),
        ]
        .concat()
    });
}

/// The lines of the convention `social-gan`.
pub(super) fn social_gan(bytes: &[u8]) {
    check(bytes, Format::SocialGan, |rows| {
        lines(rows, |f, p, [x, y]| format!("{f}\t{p}.0\t{x:e}\t{y}"))
    });
}

/// TrajNet++ ndjson.
pub(super) fn trajnet(bytes: &[u8]) {
    check(bytes, Format::TrajNet, |rows| {
        lines(rows, |f, p, [x, y]| {
            format!("{{\"track\": {{\"y\": {y:?}, \"x\": {x:?}, \"p\": {p}, \"f\": {f}}}}}")
        })
    });
}

/// The eight columns of `obsmat.txt`.
pub(super) fn obsmat(bytes: &[u8]) {
    check(bytes, Format::Obsmat, |rows| {
        lines(rows, |f, p, [x, y]| format!("{f}.0 {p} {x} 0 {y} nan 0 1e300"))
    });
}

/// Reads bytes as a file of tracks. The recording must keep its bounds and, written in the same format with its rows in
/// reverse order, be read back unchanged.
fn check(bytes: &[u8], format: Format, written: fn(&[Observation]) -> String) {
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
    let mut rows = recording.observations().to_vec();
    rows.reverse();
    // The rate is not part of the rows.
    let rate = recording
        .rate()
        .map(|fps| format!("{{\"scene\": {{\"fps\": {fps}}}}}\n"));
    let text = rate.unwrap_or_default() + &written(&rows);
    let again = parse_recording(text.as_bytes(), "fuzzed", format)
        .unwrap_or_else(|error| panic!("a written recording is refused: {error}\n{text}"));
    assert_eq!(again, recording, "{text}");
}

/// The bounds that callers of the readers rely on.
pub(super) fn bounded(recording: &Recording) {
    for seen in recording.observations() {
        assert!(
            seen.position.iter().all(|c| c.abs() <= ddl_data::COORDINATE_LIMIT),
            "{seen:?} is beyond the coordinate limit"
        );
        assert!(seen.frame.unsigned_abs() < 1 << 53, "{seen:?}");
    }
}

/// One line per row, formatted from frame, pedestrian and position.
fn lines(rows: &[Observation], line: fn(i64, PedestrianId, Position) -> String) -> String {
    let line = |seen: &Observation| line(seen.frame, seen.pedestrian, seen.position) + "\n";
    rows.iter().map(line).collect()
}
