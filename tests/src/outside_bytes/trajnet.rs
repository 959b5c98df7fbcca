//! TrajNet++ ndjson of tracks.

use ddl_data::Format;

use super::recording;

/// Reads bytes as TrajNet++ ndjson.
///
/// # Panics
/// When a law of [`outside_bytes`](super) is broken.
pub fn read(bytes: &[u8]) {
    recording::check(bytes, Format::TrajNet, |rows| {
        recording::lines(rows, |seen| {
            let [x, y] = seen.position;
            let (frame, pedestrian) = (seen.frame, seen.pedestrian);
            format!(
                "{{\"track\": {{\"y\": {y:?}, \"x\": {x:?}, \"p\": {pedestrian}, \"f\": {frame}}}}}"
            )
        })
    });
}
