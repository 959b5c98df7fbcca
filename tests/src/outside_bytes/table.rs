//! The table of one's own tracks.

use ddl_data::Format;

use super::recording;

/// Reads bytes as a table of tracks.
///
/// # Panics
/// When a law of [`outside_bytes`](super) is broken.
pub fn read(bytes: &[u8]) {
    recording::check(bytes, Format::Table, |rows| {
        let header = "y,frame,x,pedestrian\n".to_owned();
        header
            + &recording::lines(rows, |seen| {
                let [x, y] = seen.position;
                format!("{y},{},{x},{}", seen.frame, seen.pedestrian)
            })
    });
}
