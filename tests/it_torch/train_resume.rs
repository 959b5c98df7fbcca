//! Stopped training resumes with the same bytes as uninterrupted training. Killed training is tested in
//! `tests/it_torch/faults`.

#![cfg(unix)]

use ddl_tests::folder_contents::assert_same;
use ddl_tests::place::Place;
use ddl_tests::processes;
use ddl_tests::program::Finished;
use ddl_tests::trained_model::{TRAIN, finish, undisturbed};
use std::io::{BufRead as _, BufReader};

/// Steps before those of the forecasting network: 12 of the proposal network, and 24 of its memory branch.
const GOAL_STEPS: usize = 36;

/// Trains for some steps, then sends the signal and waits for the end.
fn interrupted(place: &Place, steps: usize, signal: &str) -> Finished {
    let mut child = place.start(&format!("{TRAIN} --progress json"));
    let mut lines = BufReader::new(child.stdout.take().unwrap()).lines();
    for _ in 0..steps {
        lines.next().unwrap().unwrap();
    }
    processes::signal(child.id(), signal);
    // Read on, so that the program is not blocked by a full pipe.
    lines.for_each(|line| drop(line.unwrap()));
    let output = child.wait_with_output().unwrap();
    Finished::new(format!("train, {signal}"), &output)
}

/// SIGINT (Ctrl-C) and SIGTERM: the current step is finished, everything saved, exit code 130.
#[test]
fn an_interrupted_run_resumes_to_the_same_bytes() {
    let place = Place::empty();
    let in_the_first_stage = GOAL_STEPS / 2;
    for (steps, signal, state) in [
        (in_the_first_stage, "INT", "proposal-state"),
        (GOAL_STEPS - in_the_first_stage + 8, "INT", "optimizer"),
        (3, "TERM", "optimizer"),
    ] {
        let finished = interrupted(&place, steps, signal);
        assert_eq!(finished.code, Some(130), "{finished:#?}");
        for words in ["run, ", " batches", "saved", "the same command"] {
            assert!(finished.stderr.contains(words), "{finished:#?}");
        }
        assert!(place.at(&format!("run/{state}.safetensors")).is_file());
        assert!(!place.at("run/model.safetensors").exists(), "it had ended before");
    }
    // No unfinished file remains.
    assert_same(&undisturbed().0, &finish(&place));
}
