//! The lines of the convention `social-gan`.

use ddl_data::Format;

use super::recording;

/// Reads bytes as a file of the convention `social-gan`.
///
/// # Panics
/// When a law of [`outside_bytes`](super) is broken.
pub fn read(bytes: &[u8]) {
    recording::check(bytes, Format::SocialGan, |rows| {
        recording::lines(rows, |seen| {
            let [x, y] = seen.position;
            format!("{}\t{}.0\t{x:e}\t{y}", seen.frame, seen.pedestrian)
        })
    });
}
