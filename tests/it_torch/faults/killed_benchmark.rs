//! `kill -9` at any moment of a benchmark: the same command resumes it with the same results.

use ddl_tests::chance::Chance;
use ddl_tests::folder_contents::{self, Contents, assert_same, half_written};
use ddl_tests::place::Place;
use ddl_tests::trained_model::without_seconds;
use ddl_tests::{nightly, processes, program};
use std::os::unix::process::ExitStatusExt as _;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

const BENCHMARK: &str = "benchmark --convention simulated --profile smoke --folds corridor --seeds 1,2 \
                         --train-pedestrians 64 --test-pedestrians 20 --protocol fair --jobs 2 --out out";

fn benchmark(place: &Place) -> Command {
    let mut command = program::command(place.path(), BENCHMARK);
    command.stdout(Stdio::null()).stderr(Stdio::null());
    command
}

fn begun(place: &Place) -> Child {
    let mut child = benchmark(place).spawn().unwrap();
    while !place.at("out/plan.json").exists() {
        assert!(child.try_wait().unwrap().is_none());
        std::thread::sleep(Duration::from_millis(2));
    }
    child
}

fn kill_all(child: &mut Child) {
    // The benchmark first, so that it starts no new process.
    for id in processes::with_descendants(child.id()) {
        processes::signal(id, "KILL");
    }
    child.wait().unwrap();
}

/// Weights and results of a finished benchmark, without durations, which vary.
fn finish(place: &Place) -> Contents {
    let status = benchmark(place).status().unwrap();
    let mut contents = folder_contents::read(&place.at("out"));
    let logs = contents.iter().filter(|(name, _)| name.ends_with("log.txt"));
    let logs = logs.map(|(_, log)| String::from_utf8_lossy(log.as_deref().unwrap_or_default()));
    assert!(status.success(), "{status}: {}", logs.collect::<String>());
    let compared = ["model.safetensors", "proposal.safetensors", "report.json", "moments.json", "summary.md"];
    contents.retain(|name, _| compared.iter().any(|compared| name.ends_with(compared)));
    for (name, bytes) in &mut contents {
        if let (true, Some(bytes)) = (name.ends_with("report.json"), bytes) {
            *bytes = without_seconds(str::from_utf8(bytes).unwrap()).into_bytes();
        }
    }
    contents
}

/// In half of the rounds all processes are killed, in the others only the benchmark, whose child processes continue.
#[test]
fn a_killed_benchmark_ends_in_the_same_results() {
    let clock = Instant::now();
    let expected = finish(&Place::empty());
    let takes = clock.elapsed();
    let rounds = nightly::rounds(2, 50);
    let mut chance = Chance::new("killed benchmark");
    for round in 0..rounds {
        let place = Place::empty();
        let mut moment = chance.moment((round, rounds), takes);
        // A benchmark that finishes before it is killed is started again, and killed earlier.
        loop {
            let mut child = benchmark(&place).spawn().unwrap();
            std::thread::sleep(moment);
            if round % 2 == 0 {
                kill_all(&mut child);
            } else {
                child.kill().unwrap();
            }
            if child.wait().unwrap().signal().is_some() {
                break;
            }
            moment = moment.mul_f64(0.8);
            let _ = std::fs::remove_dir_all(place.at("out"));
        }
        eprintln!("killed after {moment:?}, round {round}");
        assert_same(&expected, &finish(&place));
        assert_eq!(half_written(place.path()), Vec::<String>::new());
    }
}

#[test]
fn a_second_benchmark_is_refused_and_an_interrupted_one_resumes() {
    let place = Place::empty();
    let log = place.at("out/corridor-full-1/log.txt");
    let trainings = || std::fs::read_to_string(&log).unwrap_or_default().matches("$ ddl train").count();
    for signal in ["INT", "TERM"] {
        let before = trainings();
        let mut child = begun(&place);
        while trainings() == before {
            std::thread::sleep(Duration::from_millis(2));
        }
        let message = place.run(BENCHMARK).fails();
        for words in ["another process works", "choose another"] {
            assert!(message.contains(words), "{message}");
        }
        let processes = processes::with_descendants(child.id());
        processes::signal(child.id(), signal);
        assert_eq!(child.wait().unwrap().code(), Some(130), "{signal}");
        for id in processes {
            let line = std::fs::read_to_string(format!("/proc/{id}/cmdline"));
            let is_left = line.is_ok_and(|line| line.contains("corridor"));
            assert!(!is_left, "{id} is left");
        }
    }
    let _ = finish(&place);
}
