//! A user's own tracks with something wrong, and outputs that have no place to go.

use super::{FORECAST, fails, folder_with_model};
use ddl_tests::own_tracks;

#[test]
fn a_bad_line_of_tracks_is_named() {
    let folder = folder_with_model();
    let tracks = folder.path().join("tracks.csv");
    let good = own_tracks::csv(&own_tracks::three_people(9));
    let lines: Vec<&str> = good.lines().collect();
    for (bad, needle) in [
        ("10,1,left,2.0", "\"left\""),
        ("10,1,2.0", "3 fields"),
        ("10,1,NaN,2.0", "finite"),
        ("10,1,1e999,2.0", "finite"),
        ("ten,1,2.0,2.0", "\"ten\""),
        ("0,1,5.0,5.0", "already"),
    ] {
        let mut lines = lines.clone();
        lines[4] = bad;
        std::fs::write(&tracks, lines.join("\n")).unwrap();
        fails(folder.path(), FORECAST, &["tracks.csv", "line 5", needle]);
    }
    let headless = lines[1..].join("\n");
    for (text, needle) in [("", "empty"), (lines[0], "empty"), (&headless, "header")] {
        std::fs::write(&tracks, text).unwrap();
        fails(folder.path(), FORECAST, &["tracks.csv", "line 1", needle]);
    }
}

#[test]
fn missing_tracks_are_named() {
    let folder = folder_with_model();
    std::fs::remove_file(folder.path().join("tracks.csv")).unwrap();
    fails(folder.path(), FORECAST, &["tracks.csv", "No such file"]);
}

#[test]
fn tracks_too_short_to_forecast_are_refused() {
    let folder = folder_with_model();
    let tracks = own_tracks::csv(&own_tracks::three_people(7));
    std::fs::write(folder.path().join("tracks.csv"), tracks).unwrap();
    fails(folder.path(), FORECAST, &["tracks.csv", "8 frames"]);
}

#[test]
fn an_output_that_cannot_be_written_is_named() {
    let folder = folder_with_model();
    let output = "forecast --model run tracks.csv --output no/out.csv";
    fails(folder.path(), output, &["no/out.csv"]);
}
