//! Thousands of pedestrians in one frame.

use ddl_tests::chance::Chance;
use ddl_tests::place::Place;
use ddl_tests::{nightly, own_tracks, processes, program};
use std::fs::File;
use std::process::Stdio;
use std::time::Duration;

/// Pedestrians per square metre: a dense crowd in which pedestrians can still walk.
const DENSITY: f64 = 0.5;
const GIB: u64 = 1 << 30;

/// A crowd in a square for some frames, in which every pedestrian walks straight at up to 1.4 m/s.
fn crowd(count: usize, frames: i64) -> Vec<own_tracks::Row> {
    let mut chance = Chance(fastrand::Rng::with_seed(count as u64));
    let side = (count as f64 / DENSITY).sqrt();
    let mut number = |least: f64, most: f64| least + (most - least) * chance.below(1 << 20) as f64 / f64::from(1 << 20);
    let pedestrian = |_| [(0.0, side), (0.0, side), (-1.0, 1.0), (-1.0, 1.0)].map(|(a, b)| number(a, b));
    let pedestrians: Vec<[f64; 4]> = (0..count).map(pedestrian).collect();
    let rows_at = |frame: i64| {
        let t = 0.4 * frame as f64;
        (0..).zip(&pedestrians).map(move |(id, [x, y, u, v])| (frame, id, x + t * u, y + t * v))
    };
    (0..frames).flat_map(rows_at).collect()
}

/// Processor time and peak memory of a command with a crowd as its input, and the number of lines it printed.
fn measured(place: &Place, line: &str, count: usize, frames: i64) -> (Option<(Duration, u64)>, usize) {
    place.write_tracks("crowd.csv", &crowd(count, frames));
    let mut child = program::command(place.path(), line)
        .stdin(File::open(place.at("crowd.csv")).unwrap())
        .stdout(File::create(place.at("printed")).unwrap())
        .stderr(Stdio::inherit())
        .spawn()
        .unwrap();
    let (status, seen) = processes::watch(&mut child);
    assert!(status.success(), "{line}: {status:?}");
    (seen, place.text("printed").lines().count())
}

/// Runs a command with a crowd, and with a crowd a quarter as large. Four times the pedestrians may take slightly more
/// than four times the time, not sixteen times.
#[test]
fn thousands_of_pedestrians_are_forecast() {
    for (what, line, (count, frames), lines, most) in [
        (
            "a crowd, one forecast per pedestrian",
            "crowd.csv --last --one",
            (nightly::rounds(2_000, 10_000), 8),
            (|count| 1 + 12 * count) as fn(usize) -> usize,
            2 * GIB,
        ),
        (
            "a crowd, 20 hypotheses per pedestrian",
            "crowd.csv --last --format jsonl",
            (nightly::rounds(600, 10_000), 8),
            |count| count,
            nightly::rounds(2, 12) * GIB,
        ),
        (
            "a live crowd, one forecast per pedestrian, 5 frames",
            "- --one --whole --frame-step 1",
            (nightly::rounds(1_000, 10_000), 12), // five of these frames have 8 observed frames
            |count| 1 + 5 * 12 * count,
            2 * GIB,
        ),
    ] {
        let place = Place::with_model();
        let line = format!("forecast {line} --model run --threads 1");
        let few = count / 4;
        let quarter = measured(&place, &line, few, frames);
        let whole = measured(&place, &line, count, frames);
        assert_eq!((quarter.1, whole.1), (lines(few), lines(count)));
        let (Some((less, _)), Some((time, bytes))) = (quarter.0, whole.0) else {
            eprintln!("skipped: this system does not report the time and memory of a process");
            continue;
        };
        let [less, time] = [less, time].map(|time| time.as_secs_f64());
        let factor = time / less;
        assert!(factor < 11.0, "{what}: {factor} times as long for four times the pedestrians");
        assert!(bytes < most, "{what}: {bytes} bytes");
        let mib = bytes >> 20;
        eprintln!("{what}: {time:.1} s for {count} pedestrians, {less:.1} s for {few}; at most {mib} MiB");
    }
}
