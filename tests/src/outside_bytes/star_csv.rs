//! The four lines of the convention `star`.

use ddl_data::{Format, Observation};

use super::recording;

/// Reads bytes as a file of the convention `star`.
///
/// # Panics
/// When a law of [`outside_bytes`](super) is broken.
pub fn read(bytes: &[u8]) {
    recording::check(bytes, Format::StarCsv, |rows| {
        let column = |field: &dyn Fn(&Observation) -> String| {
            rows.iter().map(field).collect::<Vec<_>>().join(",") + "\n"
        };
        [
            column(&|seen| seen.frame.to_string()),
            column(&|seen| seen.pedestrian.to_string()),
            column(&|seen| seen.position[1].to_string()),
            column(&|seen| seen.position[0].to_string()),
        ]
        .concat()
    });
}
