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
    let tracks = |frames| own_tracks::csv(&own_tracks::three_people(frames));
    std::fs::write(folder.path().join("tracks.csv"), tracks(7)).unwrap();
    let whole = format!("{FORECAST} --whole");
    fails(
        folder.path(),
        &whole,
        &["tracks.csv", "8 steps", "10 frames"],
    );
    std::fs::write(folder.path().join("tracks.csv"), tracks(1)).unwrap();
    fails(
        folder.path(),
        FORECAST,
        &["tracks.csv", "two steps", "--fps"],
    );
}

#[test]
fn what_is_no_file_of_tracks_is_named() {
    let folder = folder_with_model();
    fails(
        folder.path(),
        "forecast --model run .",
        &[". is a folder", "ddl data ."],
    );
    fails(folder.path(), "data -", &["ddl forecast -", "name a file"]);
}

#[test]
fn a_homography_or_a_rate_that_is_none_is_named() {
    let folder = folder_with_model();
    let matrix = folder.path().join("H.txt");
    let options = format!("{FORECAST} --homography H.txt");
    fails(folder.path(), &options, &["H.txt", "No such file"]);
    for (text, needle) in [
        ("1 0 0\n0 1 0\n", "three rows"),
        ("1 0 0\n0 1 zero\n0 0 1\n", "line 2"),
        ("1 0 0\n1 0 0\n0 0 1\n", "singular"),
    ] {
        std::fs::write(&matrix, text).unwrap();
        fails(folder.path(), &options, &["H.txt", needle]);
    }
    std::fs::write(&matrix, "0 0 1\n0 1 0\n1 0 0\n").unwrap(); // x = 0 is the horizon
    fails(
        folder.path(),
        &options,
        &["tracks.csv", "pedestrian 1, frame 0", "horizon"],
    );
    // rows are 10 frames apart
    let slow = format!("{FORECAST} --fps 5");
    fails(folder.path(), &slow, &["tracks.csv", "2.00 s apart"]);
    for (option, problem) in [
        ("--fps 0", "above 0"),
        ("--fps many", "must be a number"),
        ("--dt=-1", "above 0"),
        ("--fps 25 --dt 0.04", "cannot be used with"),
        ("--fps 25 --frame-step 10", "cannot be used with"),
    ] {
        let finished = ddl_tests::program::run(folder.path(), &format!("{FORECAST} {option}"));
        assert_eq!(finished.code, Some(2), "{option}");
        assert!(finished.stderr.contains(problem), "{finished:?}");
    }
}

#[test]
fn an_output_that_cannot_be_written_is_named() {
    let folder = folder_with_model();
    let output = "forecast --model run tracks.csv --output no/out.csv";
    fails(folder.path(), output, &["no/out.csv"]);
}
