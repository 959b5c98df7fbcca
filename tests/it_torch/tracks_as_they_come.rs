//! Tracks that are not as a data set has them: begun late, with holes, of another rate, in pixels.

use ddl::Variant;
use ddl_tests::own_tracks::{self, Row};
use ddl_tests::program::{self, Finished};
use ddl_tests::tiny_model;
use serde_json::Value;
use std::path::Path;

fn forecast_in(folder: &Path, rows: &[Row], options: &str) -> Finished {
    std::fs::write(folder.join("tracks.csv"), own_tracks::csv(rows)).unwrap();
    let line = format!("forecast --model . tracks.csv --threads 1 --format jsonl {options}");
    program::run(folder, &line)
}

fn forecast(rows: &[Row], options: &str) -> Finished {
    forecast_in(tiny_model::folder(Variant::Full).path(), rows, options)
}

fn lines(text: &str) -> Vec<Value> {
    let parsed = text.lines().map(serde_json::from_str);
    parsed.collect::<Result<_, _>>().unwrap()
}

/// Moment, pedestrian, positions padded and filled.
fn made_up(line: &Value) -> (i64, i64, u64, u64) {
    let whole = |name: &str| line[name].as_i64().unwrap();
    let count = |name: &str| line[name].as_u64().unwrap();
    let (moment, who) = (whole("observed_until"), whole("pedestrian"));
    (moment, who, count("padded"), count("filled"))
}

#[test]
fn late_comers_and_holes_are_forecast_and_flagged() {
    let mut rows = own_tracks::three_people(10);
    // the second comes at frame 60, the third is not seen at 40 and 50
    rows.retain(|&(frame, who, _, _)| {
        !(who == 2 && frame < 60 || who == 3 && [40, 50].contains(&frame))
    });
    let finished = forecast(&rows, "--certificate --last");
    assert!(
        finished.stderr.contains(
            "of 3 forecasts 1 are of people seen for less than 8 steps, and 1 over holes"
        ),
        "{finished:?}"
    );
    let all = lines(&finished.succeeds());
    let found: Vec<_> = all.iter().map(made_up).collect();
    assert_eq!(found, [(90, 1, 0, 0), (90, 2, 4, 0), (90, 3, 0, 2)]);
    for line in &all {
        for hypothesis in line["hypotheses"].as_array().unwrap() {
            assert_eq!(hypothesis["certificate"]["holds"], true);
        }
    }
    let whole = forecast(&rows, "--last --whole");
    assert_eq!(whole.stderr, "");
    let found: Vec<_> = lines(&whole.succeeds()).iter().map(made_up).collect();
    assert_eq!(found, [(90, 1, 0, 0)]);
    // who has just appeared is counted
    rows.push((90, 4, 3.0, 1.0));
    let missing = "1 of the 4 people at frame 90 were seen at too few of the last 8 steps";
    let appeared = forecast(&rows, "--last");
    assert!(appeared.stderr.contains(missing), "{appeared:?}");
}

/// The same walks filmed at 25 frames a second say the same at the frames that both have.
#[test]
fn a_faster_camera_forecasts_at_every_frame() {
    let walks = own_tracks::three_people(9);
    let rows: Vec<Row> = (0..=80)
        .flat_map(|frame| {
            let at = |frame: i64| walks.iter().filter(move |row| row.0 == frame);
            let (before, share) = (frame / 10 * 10, (frame % 10) as f64 / 10.0);
            let after = if before < 80 { before + 10 } else { before };
            at(before).zip(at(after)).map(move |(a, b)| {
                let between = |a: f64, b: f64| a + share * (b - a);
                (frame, a.1, between(a.2, b.2), between(a.3, b.3))
            })
        })
        .collect();
    let slow = forecast(&walks, "--whole --fps 25").succeeds();
    let fast = lines(&forecast(&rows, "--whole --fps 25").succeeds());
    let moments: Vec<i64> = fast.iter().map(|line| made_up(line).0).collect();
    assert_eq!((moments.first(), moments.last()), (Some(&70), Some(&80)));
    assert_eq!(fast.len(), 11 * 3);
    let both = |line: &&Value| made_up(line).0 % 10 == 0;
    let fast: Vec<&Value> = fast.iter().filter(both).collect();
    assert_eq!(fast.len(), 6);
    for (slow, fast) in lines(&slow).iter().zip(fast) {
        assert_eq!(slow, fast);
    }
}

#[test]
fn a_rate_that_meets_no_step_is_resampled_and_said() {
    let rows: Vec<Row> = (0..=72)
        .map(|frame| (frame, 1, 0.05 * frame as f64, 1.0))
        .collect();
    let finished = forecast(&rows, "--fps 24 --last");
    assert!(
        finished.stderr.contains("0.4 s are 9.6 frames"),
        "{finished:?}"
    );
    let all = lines(&finished.succeeds());
    assert_eq!(made_up(&all[0]), (72, 1, 0, 0));
    let frames: Vec<f64> = all[0]["frames"]
        .as_array()
        .unwrap()
        .iter()
        .map(|f| f.as_f64().unwrap())
        .collect();
    assert!(
        (frames[0] - 81.6).abs() < 1e-9 && (frames[11] - 187.2).abs() < 1e-9,
        "{frames:?}"
    );
    assert_eq!(all[0]["frames"][4], 120);
}

/// Pixels of a camera that looks straight down: 50 a metre, y downwards.
#[test]
fn pixels_become_metres() {
    let folder = tiny_model::folder(Variant::Full);
    let metres = own_tracks::three_people(8);
    let pixels: Vec<Row> = metres
        .iter()
        .map(|&(f, i, x, y)| (f, i, 64.0 * x + 320.0, 240.0 - 64.0 * y))
        .collect();
    std::fs::write(
        folder.path().join("H.txt"),
        "0.015625 0 -5\n0 -0.015625 3.75\n0 0 1\n",
    )
    .unwrap();
    let expected = forecast_in(folder.path(), &metres, "--whole").succeeds();
    let found = forecast_in(folder.path(), &pixels, "--whole --homography H.txt").succeeds();
    assert_eq!(lines(&found), lines(&expected));
    let raw = forecast_in(folder.path(), &pixels, "--whole");
    assert!(raw.stderr.contains("--homography"), "{raw:?}");
}
