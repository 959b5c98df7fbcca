//! Errors are part of the interface: exit code 1, one clear line, and nothing written.

mod of_models;
mod of_tracks;
mod of_training;

use ddl_tests::tiny_model::folder_with_model;
use ddl_tests::{folder_contents, program};
use std::path::Path;

const FORECAST: &str = "forecast --model run tracks.csv --output out.csv";

/// Fails in `folder` without writing anything there, and says all of `needles`.
fn fails(folder: &Path, command_line: &str, needles: &[&str]) {
    let before = folder_contents::read(folder);
    let message = program::run(folder, command_line).fails();
    let after = folder_contents::read(folder);
    let written = folder_contents::differences(&before, &after);
    assert_eq!(written, Vec::<String>::new(), "{command_line}");
    for needle in needles {
        assert!(message.contains(needle), "`{needle}` is not in: {message}");
    }
}
