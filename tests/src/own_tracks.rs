//! Tracks like those of a user of the program, as CSV.

use crate::crowd;
use ddl_core::{PedestrianId, Position};
use ddl_data::Recording;
use std::collections::BTreeMap;
use std::fmt::Write as _;

/// One row: frame, pedestrian, x and y in metres.
pub type Row = (i64, i64, f64, f64);

/// Raw frames between two rows of a pedestrian.
pub const FRAME_STEP: i64 = 10;

/// Coordinates are multiples of this, about a millimetre, as from a tracker. It is a power of two, so that moving the
/// origin of the map by whole metres needs no rounding.
const RESOLUTION: f64 = 1.0 / 1024.0;

/// Three pedestrians for `frames` frames of 0.4 s: one walks east, one walks towards it, one hardly moves.
pub fn three_pedestrians(frames: i64) -> Vec<Row> {
    let place = |t: f64, pedestrian: i64| match pedestrian {
        1 => (0.5 * t, 0.05 * (1.3 * t).sin()),
        2 => (9.0 - 0.45 * t, 0.8 + 0.04 * t),
        _ => (4.0 + 0.02 * (2.1 * t).sin(), -1.5 + 0.01 * t),
    };
    (0..frames)
        .flat_map(|t| (1..=3).map(move |pedestrian| (t, pedestrian)))
        .map(|(t, pedestrian)| {
            let (x, y) = place(t as f64, pedestrian);
            let [x, y] = [x, y].map(|c: f64| (c / RESOLUTION).round() * RESOLUTION);
            (t * FRAME_STEP, pedestrian, x, y)
        })
        .collect()
}

/// Whether a printed position of a table, rounded to 0.1 mm, is this one.
pub fn alike_in_a_table(printed: [f64; 2], position: [f64; 2]) -> bool {
    (0..2).all(|axis| (printed[axis] - position[axis]).abs() <= 0.5001e-4)
}

/// The rows as the program reads them.
pub fn csv(rows: &[Row]) -> String {
    let mut text = "frame,pedestrian,x,y\n".to_owned();
    for (frame, pedestrian, x, y) in rows {
        let _ = writeln!(text, "{frame},{pedestrian},{x},{y}"); // writing to a string cannot fail
    }
    text
}

/// A part of a simulated crowd, as a recording of a user.
pub fn of_scene(scene: &str, frames: std::ops::Range<i64>) -> Vec<Row> {
    of_recording(crowd::dataset().recording(scene).expect("the simulated scene exists"), frames)
}

/// The rows of these frames.
pub fn of_recording(recording: &Recording, frames: std::ops::Range<i64>) -> Vec<Row> {
    let seen = recording.observations().iter();
    seen.filter(|seen| frames.contains(&seen.frame))
        .map(|seen| {
            let [x, y] = seen.position;
            (seen.frame, seen.pedestrian.0, x, y)
        })
        .collect()
}

/// The pedestrians of each frame.
pub fn frames(rows: &[Row]) -> BTreeMap<i64, Vec<(PedestrianId, Position)>> {
    let mut frames = BTreeMap::<_, Vec<_>>::new();
    for &(frame, id, x, y) in rows {
        frames.entry(frame).or_default().push((PedestrianId(id), [x, y]));
    }
    frames
}

/// The rows in the TrajNet++ format.
pub fn ndjson(rows: &[Row]) -> String {
    let line = |(f, p, x, y): &Row| format!("{{\"track\": {{\"f\": {f}, \"p\": {p}, \"x\": {x}, \"y\": {y}}}}}\n");
    rows.iter().map(line).collect()
}
