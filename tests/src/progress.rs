//! The output of `--progress json`.

use crate::place::{Place, json_lines};
use serde::Deserialize;

/// A line of the progress.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Progress {
    /// The stage of the work.
    pub stage: String,
    /// Work done, out of [`total`](Self::total).
    pub done: f64,
    /// Total work, constant within a stage.
    pub total: f64,
    /// A message for the user.
    pub message: String,
}

/// Runs a command with `--progress json`, and checks its stages: none, or these ones, each to its end.
pub fn reported(place: &Place, line: &str, expected: &[&str]) -> Vec<Progress> {
    let lines: Vec<Progress> = json_lines(&place.ok(&format!("{line} --progress json")));
    let stages: Vec<&[Progress]> = lines.chunk_by(|a, b| a.stage == b.stage).collect();
    let names: Vec<&str> = stages.iter().map(|lines| &*lines[0].stage).collect();
    assert!(names.is_empty() || names == expected, "{names:?}");
    for lines in stages {
        let total = lines[0].total;
        for line in lines {
            assert!(!line.message.is_empty() && line.total.to_bits() == total.to_bits());
        }
        assert!(total > 0.0 && lines.is_sorted_by(|a, b| a.done <= b.done));
        let done = lines.last().map_or(total, |last| last.done);
        assert_eq!(done.to_bits(), total.to_bits(), "{lines:?}");
    }
    lines
}

/// Runs a command a second time, which must do nothing, print nothing, and change nothing.
pub fn returns_at_once(place: &Place, line: &str) {
    let before = crate::folder_contents::read(place.path());
    assert!(reported(place, line, &[]).is_empty(), "worked a second time");
    place.assert_unchanged_since(&before);
}
