//! Thousands of people in one frame.

use super::Chance;
use ddl::Variant;
use ddl_tests::{figures, processes, program, tiny_model};
use std::fmt::Write as _;
use std::fs::File;
use std::path::Path;
use std::process::Stdio;
use std::time::Duration;

/// People on each square metre: a dense crowd that still walks.
const DENSITY: f64 = 0.5;
const GIB: u64 = 1 << 30;

/// A crowd in a square, each walking its way at up to 1.4 m/s, for some frames.
fn crowd(people: usize, frames: usize) -> String {
    let mut chance = Chance(people as u64);
    let side = (people as f64 / DENSITY).sqrt();
    let mut number = |least: f64, most: f64| {
        least + (most - least) * chance.below(1 << 20) as f64 / f64::from(1 << 20)
    };
    let walkers: Vec<[f64; 4]> = (0..people)
        .map(|_| {
            [
                number(0.0, side),
                number(0.0, side),
                number(-1.0, 1.0),
                number(-1.0, 1.0),
            ]
        })
        .collect();
    let mut text = "frame,pedestrian,x,y\n".to_owned();
    for frame in 0..frames {
        for (id, [x, y, u, v]) in walkers.iter().enumerate() {
            let t = 0.4 * frame as f64;
            let _ = writeln!(text, "{frame},{id},{:.3},{:.3}", x + t * u, y + t * v); // writing to a string cannot fail
        }
    }
    text
}

/// Processor time and peak memory of a command with a crowd as its input, and how many lines it printed.
fn measured(folder: &Path, line: &str, tracks: &str) -> (Option<(Duration, u64)>, usize) {
    std::fs::write(folder.join("crowd.csv"), tracks).unwrap();
    let mut child = program::command(folder, line)
        .stdin(File::open(folder.join("crowd.csv")).unwrap())
        .stdout(File::create(folder.join("printed")).unwrap())
        .stderr(Stdio::inherit())
        .spawn()
        .unwrap();
    let (status, seen) = processes::watch(&mut child);
    assert!(status.success(), "{line}: {status:?}");
    let printed = std::fs::read_to_string(folder.join("printed")).unwrap();
    (seen, printed.lines().count())
}

/// Tries a command with a crowd, and with one a quarter as large; four times the people may take little more than four times
/// the time, and not sixteen times.
fn scales(
    what: &str,
    line: &str,
    (people, frames): (usize, usize),
    lines: impl Fn(usize) -> usize,
    most_bytes: u64,
) {
    let folder = tiny_model::folder(Variant::Full);
    let quarter = measured(folder.path(), line, &crowd(people / 4, frames));
    let whole = measured(folder.path(), line, &crowd(people, frames));
    assert_eq!((quarter.1, whole.1), (lines(people / 4), lines(people)));
    let (Some((less, _)), Some((time, bytes))) = (quarter.0, whole.0) else {
        eprintln!("skipped: this system does not tell the time and memory of a process");
        return;
    };
    let ratio = time.as_secs_f64() / less.as_secs_f64();
    assert!(
        ratio < 11.0,
        "{what}: {less:?}, then {time:?} for four times the people"
    );
    assert!(bytes < most_bytes, "{what}: {bytes} bytes");
    figures::tell(
        what,
        format!(
            "{people} people in one frame, {} in another run",
            people / 4
        ),
        format!(
            "{:.1} s of one core ({:.1} s for a quarter of the people), at most {:.0} MiB",
            time.as_secs_f64(),
            less.as_secs_f64(),
            bytes as f64 / f64::from(1 << 20)
        ),
    );
}

#[test]
fn one_forecast_each_for_thousands() {
    let people = figures::rounds(2_000, 10_000);
    let line = "forecast crowd.csv --model . --last --one --threads 1";
    scales(
        "a crowd, one forecast each",
        line,
        (people, 8),
        |people| 1 + 12 * people,
        2 * GIB,
    );
}

#[test]
fn twenty_hypotheses_each_for_thousands() {
    let people = figures::rounds(600, 10_000);
    let line = "forecast crowd.csv --model . --last --format jsonl --threads 1";
    scales(
        "a crowd, 20 hypotheses each",
        line,
        (people, 8),
        |people| people,
        figures::rounds(2, 12) * GIB,
    );
}

#[test]
fn a_live_crowd() {
    let people = figures::rounds(1_000, 10_000);
    let line = "forecast - --model . --one --whole --frame-step 1 --threads 1";
    let frames = 12; // of which five have everybody for 8 frames
    scales(
        "a live crowd, one forecast each, 5 frames",
        line,
        (people, frames),
        |people| 1 + 5 * 12 * people,
        2 * GIB,
    );
}
