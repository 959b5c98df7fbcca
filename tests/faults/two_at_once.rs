//! Two processes in one directory: the second is refused, at once, and a killed one leaves no lock behind.

use super::TRAIN;
use ddl_tests::program;
use std::io::{BufRead as _, BufReader};
use std::process::Stdio;

#[test]
fn a_second_training_in_the_same_directory_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let mut command = program::command(folder.path(), &format!("{TRAIN} --progress json"));
    let mut first = command
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let mut lines = BufReader::new(first.stdout.take().unwrap()).lines();
    lines.next().unwrap().unwrap();
    // it may not get on meanwhile
    ddl_tests::processes::signal(first.id(), "STOP");
    for _ in 0..3 {
        let message = program::run(folder.path(), TRAIN).fails();
        for needle in ["run run:", "another process", "choose another"] {
            assert!(message.contains(needle), "`{needle}` is not in: {message}");
        }
    }
    // another directory is free
    let _ = program::run(folder.path(), &TRAIN.replace("--out run", "--out other")).succeeds();
    first.kill().unwrap();
    first.wait().unwrap();
    let _ = program::run(folder.path(), TRAIN).succeeds();
    ddl_tests::figures::tell(
        "two trainings in one directory",
        "the second 3 times, then after a `kill -9` of the first",
        "refused each time, naming the directory; free after the kill",
    );
}
