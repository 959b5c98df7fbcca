//! `kill -9` at any moment of a training: the same command resumes it with the same bytes.

use ddl_tests::chance::Chance;
use ddl_tests::folder_contents::{self, assert_same, half_written};
use ddl_tests::place::{Place, json_lines};
use ddl_tests::trained_model::{TRAIN, finish, undisturbed};
use ddl_tests::{nightly, program, safetensors_file};
use serde_json::Value;
use std::process::{Child, Stdio};
use std::time::Duration;

fn start(place: &Place) -> Child {
    let mut command = program::command(place.path(), TRAIN);
    command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap()
}

fn is_writing(place: &Place) -> bool {
    ["run", "run/epochs"].iter().any(|folder| {
        let entries = std::fs::read_dir(place.at(folder)).into_iter().flatten().flatten();
        let mut names = entries.map(|entry| entry.file_name());
        names.any(|name| name.to_string_lossy().starts_with(".writing-"))
    })
}

/// Checks that every file with its final name is complete.
fn assert_whole(place: &Place) {
    for (name, bytes) in folder_contents::read(place.path()) {
        let (Some(bytes), text) = (bytes, name.display().to_string()) else {
            continue;
        };
        if text.contains(".writing-") {
            continue;
        }
        match name.extension().and_then(|extension| extension.to_str()) {
            Some("safetensors") => drop(safetensors_file::parts(&bytes).unwrap()),
            Some("json") => drop(serde_json::from_slice::<Value>(&bytes).unwrap()),
            Some("jsonl") => drop(json_lines::<Value>(std::str::from_utf8(&bytes).unwrap())),
            _ => {}
        }
    }
}

/// Each of the runs is killed once: half of them at moments spread over the whole run, half of them while a file is
/// being written.
#[test]
fn a_killed_training_ends_in_the_same_bytes() {
    let (expected, takes) = undisturbed();
    let rounds = nightly::rounds(3, 50);
    let mut chance = Chance::new("killed training");
    let mut unfinished = 0;
    for round in 0..rounds {
        let place = Place::empty();
        let mut moment = chance.moment((round, rounds), *takes);
        // A run that finishes before it is killed is started again, and killed earlier.
        loop {
            let mut child = start(&place);
            std::thread::sleep(moment);
            while round % 2 == 1 && !is_writing(&place) && child.try_wait().unwrap().is_none() {}
            child.kill().unwrap();
            if child.wait().unwrap().code().is_none() {
                break;
            }
            moment = moment.mul_f64(0.8);
            let _ = std::fs::remove_dir_all(place.at("run"));
        }
        unfinished += usize::from(!place.at("run/model.safetensors").exists());
        assert_whole(&place);
        eprintln!("killed after {moment:?}");
        assert_same(expected, &finish(&place));
        assert_eq!(half_written(place.path()), Vec::<String>::new());
    }
    eprintln!("killed trainings: {unfinished} of {rounds} were unfinished");
    assert!(unfinished > 0, "every run was done before it was killed");
}

/// The same run is killed repeatedly. Progress is kept from 30 s or an epoch on, and nothing is lost.
#[test]
fn a_repeatedly_killed_training_ends_in_the_same_bytes() {
    let (expected, takes) = undisturbed();
    let place = Place::empty();
    let mut chance = Chance::new("training killed again and again");
    let most = nightly::rounds(3, 20);
    let mut killed = 0;
    while killed < most && !place.at("run/model.safetensors").exists() {
        let mut child = start(&place);
        // Every attempt repeats the first parts of a run.
        let moment = chance.moment((0, 1), *takes / 2) + Duration::from_millis(1);
        std::thread::sleep(moment);
        child.kill().unwrap();
        killed += usize::from(child.wait().unwrap().code().is_none());
        assert_whole(&place);
    }
    eprintln!("one training, killed {killed} times");
    assert!(killed > 0, "the training was done before it was killed");
    assert_same(expected, &finish(&place));
}
