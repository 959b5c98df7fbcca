//! `kill -9` at any moment of a benchmark: the same command goes on to the same results.

use super::{Chance, half_written};
use ddl_tests::folder_contents::{self, Contents};
use ddl_tests::{figures, processes, program};
use serde_json::Value;
use std::os::unix::process::ExitStatusExt as _;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// A benchmark of two models, each of which takes some seconds.
const BENCHMARK: &str = "benchmark --convention simulated --profile smoke --folds corridor --seeds 1,2 --train-walkers 64 --test-walkers 20 \
                         --protocol fair --jobs 2 --out out";

fn benchmark(folder: &Path) -> Command {
    let mut command = program::command(folder, BENCHMARK);
    command.stdout(Stdio::null()).stderr(Stdio::null());
    command
}

/// One that has claimed its folder.
fn begun(folder: &Path) -> Child {
    let mut child = benchmark(folder).spawn().unwrap();
    while !folder.join("out/plan.json").exists() {
        assert!(child.try_wait().unwrap().is_none());
        std::thread::sleep(Duration::from_millis(2));
    }
    child
}

/// Files of a finished benchmark without what differs from time to time: seconds, and logs.
fn results(folder: &Path) -> Contents {
    let mut contents = folder_contents::read(&folder.join("out"));
    contents.retain(|name, _| {
        let name = name.to_string_lossy();
        !name.ends_with("log.txt") && !name.ends_with("optimizer.safetensors")
    });
    for (name, bytes) in &mut contents {
        let Some(bytes) = bytes else { continue };
        let extension = name.extension().and_then(|extension| extension.to_str());
        let text = || String::from_utf8_lossy(bytes).into_owned();
        match extension {
            Some("json") => {
                let mut value: Value = serde_json::from_slice(bytes).unwrap();
                forget_seconds(&mut value);
                *bytes = value.to_string().into_bytes();
            }
            Some("jsonl") => {
                let lines = text();
                let lines = lines.lines().map(|line| {
                    let mut value: Value = serde_json::from_str(line).unwrap();
                    forget_seconds(&mut value);
                    value.to_string()
                });
                *bytes = lines.collect::<Vec<_>>().join("\n").into_bytes();
            }
            // They tell the same as report.json, and how long it took.
            Some("md" | "html" | "tex") => bytes.clear(),
            _ => {}
        }
    }
    contents
}

fn forget_seconds(value: &mut Value) {
    match value {
        Value::Object(fields) => {
            fields.retain(|name, _| !name.contains("seconds"));
            fields.values_mut().for_each(forget_seconds);
        }
        Value::Array(items) => items.iter_mut().for_each(forget_seconds),
        _ => {}
    }
}

fn finish(folder: &Path) -> Contents {
    let status = benchmark(folder).status().unwrap();
    if !status.success() {
        let logs = folder_contents::read(&folder.join("out"));
        let logs = logs.iter().filter(|(name, _)| name.ends_with("log.txt"));
        let logs: Vec<_> = logs
            .map(|(_, log)| String::from_utf8_lossy(log.as_deref().unwrap_or_default()))
            .collect();
        panic!("{status}: {}", logs.join("\n"));
    }
    results(folder)
}

/// Whether a benchmark was killed so long after its start, rather than done by then: with all its processes, or alone.
fn killed_after(moment: Duration, folder: &Path, with_processes: bool) -> bool {
    let mut child = benchmark(folder).spawn().unwrap();
    std::thread::sleep(moment);
    if with_processes {
        // the benchmark first, so that it begins nothing new
        for id in processes::with_descendants(child.id()) {
            processes::signal(id, "KILL");
        }
    } else {
        child.kill().unwrap();
    }
    child.wait().unwrap().signal().is_some()
}

/// Half of the times everything is killed, half of the times the benchmark alone, whose processes go on by themselves.
#[test]
fn a_killed_benchmark_ends_in_the_same_results() {
    let whole = tempfile::tempdir().unwrap();
    let begun = Instant::now();
    let expected = finish(whole.path());
    let takes = begun.elapsed();
    assert!(expected.contains_key(Path::new("report.json")));
    let rounds = figures::rounds(2, 50);
    let mut chance = Chance::new("killed benchmark");
    let mut alone = 0;
    for round in 0..rounds {
        let folder = tempfile::tempdir().unwrap();
        let mut moment = chance.moment((round, rounds), takes);
        // one that is done before it is killed is begun anew, and killed earlier
        while !killed_after(moment, folder.path(), round % 2 == 0) {
            moment = moment.mul_f64(0.8);
            let _ = std::fs::remove_dir_all(folder.path().join("out"));
        }
        alone += round % 2;
        let found = finish(folder.path());
        assert_eq!(
            folder_contents::differences(&expected, &found),
            Vec::<String>::new(),
            "killed after {moment:?}, round {round}"
        );
        assert_eq!(half_written(folder.path()), Vec::<String>::new());
    }
    figures::tell(
        "`kill -9` of a benchmark",
        format!(
            "{rounds} benchmarks of 2 models, {:.1} s each, each killed once at a random moment; {alone} times the benchmark alone, whose \
             processes went on",
            takes.as_secs_f64()
        ),
        format!("{rounds} of {rounds} go on to the same results but for times"),
    );
}

#[test]
fn a_second_benchmark_in_the_same_folder_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let mut first = begun(folder.path());
    let mut second = benchmark(folder.path());
    let output = second.stderr(Stdio::piped()).output().unwrap();
    let told = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1), "{told}");
    assert!(
        told.contains("another process is at work") && told.contains("choose another"),
        "{told}"
    );
    for id in processes::with_descendants(first.id()) {
        processes::signal(id, "KILL");
    }
    first.wait().unwrap();
    let _ = finish(folder.path());
    figures::tell(
        "two benchmarks in one folder",
        "the second, then again after a `kill -9` of the first",
        "refused, naming the folder; free after the kill",
    );
}

/// Ctrl-C, and what stops a container: processes save and leave, the exit code says so, and the same command goes on.
#[test]
fn an_interrupted_benchmark_stops_cleanly_and_goes_on() {
    let folder = tempfile::tempdir().unwrap();
    let log = folder.path().join("out/corridor-full-1/log.txt");
    let trainings = || {
        let log = std::fs::read_to_string(&log).unwrap_or_default();
        log.matches("$ ddl train").count()
    };
    for signal in ["INT", "TERM"] {
        let before = trainings();
        let mut child = begun(folder.path());
        while trainings() == before {
            std::thread::sleep(Duration::from_millis(2));
        }
        let processes = processes::with_descendants(child.id());
        processes::signal(child.id(), signal);
        let status = child.wait().unwrap();
        assert_eq!(status.code(), Some(130), "{signal}");
        for id in processes {
            let line = std::fs::read_to_string(format!("/proc/{id}/cmdline"));
            assert!(
                !line.is_ok_and(|line| line.contains("corridor")),
                "{id} is left"
            );
        }
    }
    let contents = finish(folder.path());
    assert!(contents.contains_key(Path::new("report.json")));
}
