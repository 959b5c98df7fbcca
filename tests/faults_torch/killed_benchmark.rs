//! `kill -9` at any moment of a benchmark: the same command goes on to the same results.
//!
//! The benchmark is run by `cargo xtask`, which names itself to the tests that it runs.

use ddl_tests::chance::Chance;
use ddl_tests::folder_contents::{self, Contents, assert_same, half_written};
use ddl_tests::{figures, processes, program};
use serde_json::Value;
use std::os::unix::process::ExitStatusExt as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// Names the program.
const PROGRAM: &str = "DDL_XTASK";

/// A benchmark of two models, each of which takes some seconds.
fn benchmark(folder: &Path) -> Option<Command> {
    let Some(xtask) = std::env::var_os(PROGRAM) else {
        eprintln!(
            "skipped: {PROGRAM} does not name the program of `cargo xtask`, as it does under `cargo xtask test`"
        );
        return None;
    };
    let workspace = [env!("CARGO_MANIFEST_DIR"), ".."]
        .iter()
        .collect::<PathBuf>();
    let mut command = Command::new(xtask);
    command
        .args(
            "benchmark --convention simulated --profile smoke --folds corridor --seeds 1,2"
                .split(' '),
        )
        .args("--train-walkers 64 --test-walkers 20 --protocol fair --jobs 2 --program".split(' '))
        .arg(program::path())
        .arg("--out")
        .arg(folder.join("out"))
        .current_dir(workspace)
        .env_remove("DDL_COMMIT")
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null());
    Some(command)
}

/// Weights and results of a finished benchmark, without what differs from time to time: seconds.
fn results(folder: &Path) -> Contents {
    let mut contents = folder_contents::read(&folder.join("out"));
    let kept = [
        "model.safetensors",
        "proposal.safetensors",
        "report.json",
        "moments.json",
    ];
    contents.retain(|name, _| kept.iter().any(|kept| name.ends_with(kept)));
    for (name, bytes) in &mut contents {
        if let (true, Some(bytes)) = (name.ends_with("report.json"), bytes) {
            let mut report: Value = serde_json::from_slice(bytes).unwrap();
            forget_seconds(&mut report);
            *bytes = report.to_string().into_bytes();
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

fn finish(folder: &Path) -> Option<Contents> {
    let status = benchmark(folder)?.status().unwrap();
    if !status.success() {
        let logs = folder_contents::read(&folder.join("out"));
        let logs = logs.iter().filter(|(name, _)| name.ends_with("log.txt"));
        let logs: Vec<_> = logs
            .map(|(_, log)| String::from_utf8_lossy(log.as_deref().unwrap_or_default()))
            .collect();
        panic!("{status}: {}", logs.join("\n"));
    }
    Some(results(folder))
}

/// Whether a benchmark was killed so long after its start, rather than done by then: with all its processes, or alone.
fn killed_after(moment: Duration, folder: &Path, with_processes: bool) -> bool {
    let mut child = benchmark(folder).unwrap().spawn().unwrap();
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
    let Some(expected) = finish(whole.path()) else {
        return;
    };
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
        let found = finish(folder.path()).unwrap();
        eprintln!("killed after {moment:?}, round {round}");
        assert_same(&expected, &found);
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
    let Some(mut command) = benchmark(folder.path()) else {
        return;
    };
    let mut first = command.spawn().unwrap();
    while !folder.path().join("out/plan.json").exists() {
        assert!(first.try_wait().unwrap().is_none());
        std::thread::sleep(Duration::from_millis(2));
    }
    let mut second = benchmark(folder.path()).unwrap();
    let output = second.stderr(Stdio::piped()).output().unwrap();
    let told = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1), "{told}");
    assert!(
        told.contains("another benchmark") && told.contains("choose another --out"),
        "{told}"
    );
    for id in processes::with_descendants(first.id()) {
        processes::signal(id, "KILL");
    }
    first.wait().unwrap();
    assert!(finish(folder.path()).is_some());
    figures::tell(
        "two benchmarks in one folder",
        "the second, then again after a `kill -9` of the first",
        "refused, naming the folder; free after the kill",
    );
}
