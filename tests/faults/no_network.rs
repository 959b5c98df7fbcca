//! Without a network everything works, to the same bytes: nothing is fetched, nothing is told to anybody.

use super::{TRAIN, folder_with_model};
use ddl_tests::{figures, folder_contents, program, training_result};
use std::process::Command;

/// `unshare` with what this user needs to leave the network; `None`, with the reason printed, where that is not allowed.
fn without_network() -> Option<Vec<&'static str>> {
    let ways: [&[&str]; 2] = [&["unshare", "-n"], &["unshare", "-r", "-n"]];
    for way in ways {
        let output = Command::new(way[0])
            .args(&way[1..])
            .args(["cat", "/proc/net/dev"])
            .output();
        let Ok(output) = output else { continue };
        if output.status.success() {
            let interfaces = String::from_utf8(output.stdout).unwrap();
            let names = interfaces
                .lines()
                .skip(2)
                .filter_map(|line| line.trim().split(':').next());
            assert_eq!(
                names.collect::<Vec<_>>(),
                ["lo"],
                "more than the loopback interface, which is down"
            );
            return Some(way.to_vec());
        }
    }
    eprintln!("skipped: a process may not leave the network here (`unshare -n`)");
    None
}

#[test]
fn every_command_works_without_a_network() {
    let Some(way) = without_network() else { return };
    let folder = folder_with_model();
    let here = folder.path();
    let alone = |line: &str| {
        let plain = program::command(here, line);
        let mut command = Command::new(way[0]);
        command
            .args(&way[1..])
            .arg(plain.get_program())
            .args(plain.get_args())
            .current_dir(here);
        for (name, value) in plain.get_envs() {
            match value {
                Some(value) => command.env(name, value),
                None => command.env_remove(name),
            };
        }
        let output = command.output().unwrap();
        program::Finished::new(format!("without a network: ddl {line}"), &output).succeeds()
    };
    let commands = [
        "forecast --model run tracks.csv --threads 1",
        "forecast tracks.csv --one --threads 1",
        "goals --model run tracks.csv --threads 1",
        "windows --convention simulated --fold corridor",
        "info --model run",
        "info --json",
    ];
    for line in commands {
        assert_eq!(alone(line), program::run(here, line).succeeds(), "{line}");
    }
    let evaluate =
        "evaluate --model run --protocol fair --test-walkers 20 --threads 1 --out report";
    assert!(alone(evaluate).contains("minADE"));
    assert!(alone("pack --model run --out packed").contains("weights"));
    let _ = alone(&TRAIN.replace("--out run", "--out alone"));
    let elsewhere = tempfile::tempdir().unwrap();
    let _ = program::run(elsewhere.path(), TRAIN).succeeds();
    let (found, expected) = (here.join("alone"), elsewhere.path().join("run"));
    let differences = folder_contents::differences(
        &training_result::of(&expected),
        &training_result::of(&found),
    );
    assert_eq!(differences, Vec::<String>::new());
    figures::tell(
        "no network",
        format!(
            "{} commands in a network namespace without interfaces, training and evaluation among them",
            commands.len() + 3
        ),
        "all work; outputs and trained models are those with a network, byte for byte",
    );
}
