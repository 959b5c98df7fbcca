//! `kill -9` at any moment of a training: the same command goes on to the same bytes.

use super::{Chance, TRAIN, half_written};
use ddl_tests::folder_contents::{self, Contents};
use ddl_tests::{figures, program, safetensors_file, training_result};
use std::path::Path;
use std::process::{Child, Stdio};
use std::time::{Duration, Instant};

fn start(folder: &Path) -> Child {
    let mut command = program::command(folder, TRAIN);
    command
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap()
}

/// Whether a file is being written in the run.
fn is_writing(run: &Path) -> bool {
    [run.to_owned(), run.join("epochs")].iter().any(|folder| {
        let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
        let mut names = entries.map(|entry| entry.file_name());
        names.any(|name| name.to_string_lossy().starts_with(".writing-"))
    })
}

/// Every file that has its name is whole.
fn assert_whole(run: &Path) {
    if !run.exists() {
        return;
    }
    for (name, bytes) in folder_contents::read(run) {
        let (Some(bytes), text) = (bytes, name.display().to_string()) else {
            continue;
        };
        if text.contains(".writing-") {
            continue;
        }
        let whole = match name.extension().and_then(|extension| extension.to_str()) {
            Some("safetensors") => safetensors_file::parts(&bytes).map(drop),
            Some("json") => serde_json::from_slice::<serde_json::Value>(&bytes)
                .map(drop)
                .map_err(|error| error.to_string()),
            Some("jsonl") => String::from_utf8(bytes)
                .unwrap()
                .lines()
                .try_for_each(|line| {
                    let value: Result<serde_json::Value, _> = serde_json::from_str(line);
                    value.map(drop).map_err(|error| error.to_string())
                }),
            _ => Ok(()),
        };
        assert_eq!(whole, Ok(()), "{text}");
    }
}

fn finish(folder: &Path) -> Contents {
    let _ = program::run(folder, TRAIN).succeeds();
    training_result::of(&folder.join("run"))
}

/// Each of the runs is killed once: half of them at moments spread over the whole of it, half of them while a file is being written.
#[test]
fn a_killed_training_ends_in_the_same_bytes() {
    let whole = tempfile::tempdir().unwrap();
    let begun = Instant::now();
    let expected = finish(whole.path());
    let takes = begun.elapsed();
    let rounds = figures::rounds(4, 50);
    let mut chance = Chance::new("killed training");
    let (mut killed, mut while_writing, mut unfinished) = (0, 0, 0);
    for round in 0..rounds {
        let folder = tempfile::tempdir().unwrap();
        let run = folder.path().join("run");
        let mut moment = chance.moment((round, rounds), takes);
        // one that is done before it is killed is begun anew, and killed earlier
        loop {
            let mut child = start(folder.path());
            std::thread::sleep(moment);
            while round % 2 == 1 && !is_writing(&run) && child.try_wait().unwrap().is_none() {}
            child.kill().unwrap();
            if child.wait().unwrap().code().is_none() {
                break;
            }
            moment = moment.mul_f64(0.8);
            let _ = std::fs::remove_dir_all(&run);
        }
        killed += 1;
        while_writing += usize::from(is_writing(&run));
        unfinished += usize::from(!run.join("model.safetensors").exists());
        assert_whole(&run);
        let found = finish(folder.path());
        assert_eq!(
            folder_contents::differences(&expected, &found),
            Vec::<String>::new(),
            "killed after {moment:?}"
        );
        assert_eq!(half_written(folder.path()), Vec::<String>::new());
    }
    assert!(unfinished > 0, "every run was done before it was killed");
    figures::tell(
        "`kill -9` of a training",
        format!(
            "{killed} runs of {:.1} s, each killed once at a random moment, half of them while a file was open",
            takes.as_secs_f64()
        ),
        format!(
            "{killed} of {killed} go on to the same bytes; {while_writing} had a file half written, which was never read and is gone"
        ),
    );
}

/// The same run again and again: what little each attempt gets done is kept from 30 s or an epoch on, and nothing is ever lost.
#[test]
fn a_training_that_is_killed_again_and_again_ends_in_the_same_bytes() {
    let whole = tempfile::tempdir().unwrap();
    let begun = Instant::now();
    let expected = finish(whole.path());
    let takes = begun.elapsed();
    let folder = tempfile::tempdir().unwrap();
    let run = folder.path().join("run");
    let mut chance = Chance::new("training killed again and again");
    let most = figures::rounds(3, 20);
    let mut killed = 0;
    while killed < most && !run.join("model.safetensors").exists() {
        let mut child = start(folder.path());
        // the first parts of a run are gone through at every attempt
        let moment = chance.moment((0, 1), takes / 2) + Duration::from_millis(1);
        std::thread::sleep(moment);
        child.kill().unwrap();
        killed += usize::from(child.wait().unwrap().code().is_none());
        assert_whole(&run);
    }
    assert!(killed > 0, "the training was done before it was killed");
    let found = finish(folder.path());
    assert_eq!(
        folder_contents::differences(&expected, &found),
        Vec::<String>::new()
    );
    figures::tell(
        "`kill -9` again and again",
        format!("1 training, killed {killed} times in a row, until its model was there"),
        "the same bytes",
    );
}
