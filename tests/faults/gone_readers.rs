//! Readers that go, and signals: commands end without a word.

use super::{Chance, folder_with_model, half_written};
use ddl_tests::{figures, processes, program};
use std::io::Read as _;
use std::os::unix::process::ExitStatusExt as _;
use std::path::Path;
use std::process::{Child, Stdio};
use std::time::Duration;

const COMMANDS: [&str; 10] = [
    "forecast --model run tracks.csv",
    "forecast --model run tracks.csv --format jsonl",
    "goals --model run tracks.csv",
    "windows --convention simulated --fold corridor",
    "info --model run",
    "info --json",
    "evaluate --model run --protocol fair --test-walkers 20 --threads 1",
    "pack --model run --out packed",
    "train --convention simulated --fold plaza --epochs 1 --train-walkers 20 --batch-walkers 20 \
     --proposal-steps 3 --threads 1 --progress json --out new",
    "--help",
];

/// The program with a reader of each of its outputs.
fn with_readers(folder: &Path, command_line: &str) -> Child {
    program::command(folder, command_line)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap()
}

/// As in `ddl .. | head -1`, where the reader goes at once.
#[test]
fn a_reader_that_goes_ends_every_command_quietly() {
    let folder = folder_with_model();
    for line in COMMANDS {
        let mut child = with_readers(folder.path(), line);
        drop(child.stdout.take());
        let mut told = String::new();
        child
            .stderr
            .take()
            .unwrap()
            .read_to_string(&mut told)
            .unwrap();
        let status = child.wait().unwrap();
        assert_eq!(status.code(), Some(0), "{line}: {told}");
        assert!(
            !told.contains("panicked") && !told.contains("pipe"),
            "{line}: {told}"
        );
    }
    figures::tell(
        "the reader of the output goes",
        format!("{} commands", COMMANDS.len()),
        "exit code 0, no message",
    );
}

/// Nobody hears what is told to people either: `ddl .. 2>&1 | head -1`.
#[test]
fn a_reader_of_everything_that_goes_stops_no_work() {
    let folder = folder_with_model();
    for line in COMMANDS {
        let mut child = with_readers(folder.path(), line);
        drop((child.stdout.take(), child.stderr.take()));
        let status = child.wait().unwrap();
        assert_eq!(status.code(), Some(0), "{line}");
    }
    // an error has its exit code whether it is read or not
    let mut command = program::command(folder.path(), "forecast --model nowhere tracks.csv");
    let mut child = command
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stderr.take());
    assert_eq!(child.wait().unwrap().code(), Some(1));
}

/// Stopped at any moment: an output is there whole or not at all, and nothing is said but by training, which saves.
#[test]
fn a_signal_ends_a_command_quietly() {
    let folder = folder_with_model();
    let here = folder.path();
    let line = "forecast --model run tracks.csv --output out.csv";
    let _ = program::run(here, line).succeeds();
    let expected = std::fs::read(here.join("out.csv")).unwrap();
    let rounds = figures::rounds(6, 50);
    let mut chance = Chance::new("signals");
    let mut ended_by_it = 0;
    for round in 0..rounds {
        let name = ["TERM", "INT"][round % 2];
        let mut command = program::command(here, line);
        let child = command
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        std::thread::sleep(chance.moment((round, rounds), Duration::from_millis(400)));
        processes::signal(child.id(), name);
        let output = child.wait_with_output().unwrap();
        let told = String::from_utf8(output.stderr).unwrap();
        assert!(told.is_empty() || told.starts_with("note: of "), "{told}");
        let by_signal = output.status.signal().is_some();
        assert!(by_signal || output.status.success(), "{:?}", output.status);
        ended_by_it += usize::from(by_signal);
        assert!(std::fs::read(here.join("out.csv")).unwrap() == expected);
    }
    // only who is stopped in the millisecond of writing leaves something behind
    assert!(half_written(here).len() <= 1, "{:?}", half_written(here));
    figures::tell(
        "SIGTERM and SIGINT during `ddl forecast`",
        format!("{rounds} at random moments, {ended_by_it} before its end"),
        "no message, the earlier output whole",
    );
}
