//! The eight columns of `obsmat.txt`.

use ddl_data::Format;

use super::recording;

/// Reads bytes as an `obsmat.txt`.
///
/// # Panics
/// When a law of [`outside_bytes`](super) is broken.
pub fn read(bytes: &[u8]) {
    recording::check(bytes, Format::Obsmat, |rows| {
        recording::lines(rows, |seen| {
            let [x, y] = seen.position;
            format!("{}.0 {} {x} 0 {y} nan 0 1e300", seen.frame, seen.pedestrian)
        })
    });
}
