//! Closed outputs and signals end a command without a message.

use super::EVALUATE;
use ddl_tests::chance::Chance;
use ddl_tests::folder_contents::half_written;
use ddl_tests::place::Place;
use ddl_tests::{nightly, processes};
use std::os::unix::process::ExitStatusExt as _;
use std::time::Duration;

const COMMANDS: [&str; 8] = [
    "forecast --model run tracks.csv",
    "forecast --model run tracks.csv --format jsonl",
    "windows --convention simulated --fold corridor",
    "info --model run",
    "info --json",
    EVALUATE,
    "pack --model run --out packed",
    "--help",
];

/// As in `ddl .. | head -1`, where the reader closes standard output, or in `ddl .. 2>&1 | head -1`, where it closes
/// standard error as well.
#[test]
fn a_closed_output_ends_every_command_quietly() {
    let place = Place::with_model();
    for line in COMMANDS {
        let mut child = place.start(line);
        drop(child.stdout.take());
        let output = child.wait_with_output().unwrap();
        let stderr = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(0), "{line}: {stderr}");
        let of_the_reader = stderr.contains("panicked") || stderr.contains("pipe");
        assert!(!of_the_reader, "{line}: {stderr}");
        let mut child = place.start(line);
        drop((child.stdout.take(), child.stderr.take()));
        assert_eq!(child.wait().unwrap().code(), Some(0), "{line}");
    }
    // An error has its exit code even if its message is not read.
    let mut child = place.start("forecast --model nowhere tracks.csv");
    drop(child.stderr.take());
    assert_eq!(child.wait().unwrap().code(), Some(1));
}

/// A command is stopped at any moment. Its output is complete or absent, and only training prints a message, because it
/// saves its state.
#[test]
fn a_signal_ends_a_command_quietly() {
    let place = Place::with_model();
    let line = "forecast --model run tracks.csv --output out.csv";
    let _ = place.ok(line);
    let expected = place.read("out.csv");
    let rounds = nightly::rounds(6, 50);
    let mut chance = Chance::new("signals");
    let mut ended = 0;
    for round in 0..rounds {
        let child = place.start(line);
        std::thread::sleep(chance.moment((round, rounds), Duration::from_millis(400)));
        processes::signal(child.id(), if round % 2 == 0 { "TERM" } else { "INT" });
        let output = child.wait_with_output().unwrap();
        let stderr = String::from_utf8(output.stderr).unwrap();
        // Between two parts of its forecasts the program ends by itself, and says so.
        let quiet = |line: &str| line.starts_with("note: ") || line.starts_with("ddl: interrupted");
        assert!(stderr.lines().all(quiet), "{stderr}");
        let by_signal = output.status.signal().is_some() || output.status.code() == Some(130);
        assert!(by_signal || output.status.success(), "{:?}", output.status);
        assert!(place.read("out.csv") == expected);
        ended += usize::from(by_signal);
    }
    eprintln!("signals during `ddl forecast`: {ended} of {rounds} ended it");
    // Only a signal during the millisecond of writing leaves a file behind.
    let left = half_written(place.path());
    assert!(left.len() <= 1, "{left:?}");
}
