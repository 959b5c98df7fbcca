//! Errors are part of the interface: exit code 1, one clear line, and nothing written.

mod of_models;
mod of_tracks;
mod of_training;

use ddl::Variant;
use ddl_tests::{folder_contents, own_tracks, program, tiny_model};
use std::path::Path;
use tempfile::TempDir;

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

/// A folder with tracks of three people and, in `run`, the tiny model.
fn folder_with_model() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let run = folder_contents::read(tiny_model::folder(Variant::Full).path());
    folder_contents::write(&run, &folder.path().join("run"));
    let tracks = own_tracks::csv(&own_tracks::three_people(9));
    std::fs::write(folder.path().join("tracks.csv"), tracks).unwrap();
    folder
}
