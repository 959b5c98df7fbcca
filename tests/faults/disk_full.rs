//! A disk that is full, at any file of a run: the file is named, what was there before stays, and nothing half written does.

use super::{TRAIN, folder_with_model, half_written};
use ddl_tests::mount::Mount;
use ddl_tests::{figures, folder_contents, program, training_result};

/// A run of [`TRAIN`] takes some 8 MiB.
const MOST_KIBIBYTES: u64 = 10 << 10;

#[test]
fn training_goes_on_when_there_is_room() {
    let whole = tempfile::tempdir().unwrap();
    let _ = program::run(whole.path(), TRAIN).succeeds();
    let expected = training_result::of(&whole.path().join("run"));
    let folder = tempfile::tempdir().unwrap();
    let Some(disk) = Mount::small(folder.path(), 4) else {
        return;
    };
    let sizes: Vec<u64> = if figures::are_asked_for() {
        (1..50).map(|part| part * MOST_KIBIBYTES / 50).collect()
    } else {
        vec![8, 1 << 10, 5 << 10, 7 << 10]
    };
    let mut failed = Vec::new();
    for &size in &sizes {
        disk.resize(size);
        let finished = program::run(folder.path(), TRAIN);
        if finished.code == Some(0) {
            break;
        }
        let message = finished.fails();
        assert!(
            message.contains("run/") && message.contains("make room"),
            "{message}"
        );
        assert_eq!(
            half_written(folder.path()),
            Vec::<String>::new(),
            "{size} KiB"
        );
        failed.push(message.split(": ").next().unwrap_or_default().to_owned());
    }
    assert!(failed.len() > 2, "{failed:?}");
    let tried = failed.len();
    failed.dedup();
    disk.resize(MOST_KIBIBYTES);
    let _ = program::run(folder.path(), TRAIN).succeeds();
    let found = training_result::of(&folder.path().join("run"));
    assert_eq!(
        folder_contents::differences(&expected, &found),
        Vec::<String>::new()
    );
    figures::tell(
        "disk full while training",
        format!("{tried} times in one run, with a little more room each time"),
        format!(
            "stopped at {} different files, each named; then the same bytes",
            failed.len()
        ),
    );
}

/// Outputs of the other commands: an earlier one stays as it was.
#[test]
fn an_earlier_output_stays() {
    let folder = folder_with_model();
    let here = folder.path();
    let out = here.join("out");
    std::fs::create_dir(&out).unwrap();
    let Some(disk) = Mount::small(&out, 4 << 10) else {
        return;
    };
    let measure = "--protocol fair --test-walkers 20 --threads 1";
    for command in [
        "forecast --model run tracks.csv --last --output out/forecasts.csv".to_owned(),
        "goals --model run tracks.csv --whole --last --output out/goals.csv".to_owned(),
        format!("evaluate --model run {measure} --out out/report"),
        "report run --out out/page".to_owned(),
    ] {
        let _ = program::run(here, &command).succeeds();
    }
    std::fs::write(out.join("packed"), "an earlier model").unwrap();
    let before = folder_contents::read(&out);
    // whatever room there is
    let filled = std::fs::write(out.join("filler"), vec![0; 8 << 20]);
    assert!(filled.is_err());
    let mut tried = 0;
    for (command, named) in [
        (
            "forecast --model run tracks.csv --output out/forecasts.csv".to_owned(),
            "out/forecasts.csv",
        ),
        (
            "goals --model run tracks.csv --whole --output out/goals.csv".to_owned(),
            "out/goals.csv",
        ),
        ("pack --model run --out out/packed".to_owned(), "out/packed"),
        (
            "train --convention simulated --fold plaza --threads 1 --out out/new".to_owned(),
            "out/new",
        ),
    ] {
        let message = program::run(here, &command).fails();
        assert!(
            message.contains(named) && message.contains("make room"),
            "{message}"
        );
        tried += 1;
    }
    // many files: each of them is the earlier one or the new one
    let evaluate = format!("evaluate --model run {measure} --protocol single --out out/report");
    let message = program::run(here, &evaluate).fails();
    assert!(
        message.contains("out/report") && message.contains("make room"),
        "{message}"
    );
    assert_eq!(half_written(&out), Vec::<String>::new());
    let after = folder_contents::read(&out);
    for name in ["forecasts.csv", "goals.csv", "packed"] {
        let name = std::path::Path::new(name);
        assert!(
            before[name] == after[name],
            "{} has changed",
            name.display()
        );
    }
    disk.resize(64 << 10);
    let _ = program::run(here, &evaluate).succeeds();
    figures::tell(
        "disk full, other commands",
        format!("{} outputs over earlier ones", tried + 1),
        "each named, the earlier file kept; a report's files are each the earlier or the new one",
    );
}

/// What is printed has to arrive somewhere too.
#[test]
fn standard_output_that_takes_nothing_is_an_error() {
    let folder = folder_with_model();
    let commands = [
        "forecast --model run tracks.csv",
        "goals --model run tracks.csv --whole",
        "info --model run",
        "info",
        "windows --convention simulated --fold corridor",
        "forecast --model run tracks.csv --output /dev/full",
    ];
    for line in commands {
        let full = std::fs::OpenOptions::new()
            .write(true)
            .open("/dev/full")
            .unwrap();
        let output = program::command(folder.path(), line)
            .stdout(full)
            .output()
            .unwrap();
        let finished = program::Finished::new(line.to_owned(), &output);
        let message = finished.fails();
        let place = if line.contains("/dev/full") {
            "/dev/full"
        } else {
            "standard output"
        };
        assert!(
            message.contains(place) && message.contains("make room"),
            "{message}"
        );
    }
    figures::tell(
        "`/dev/full` as the output",
        format!("{} commands", commands.len()),
        "exit code 1, the output named",
    );
}
