//! Stopped training goes on as if it had never stopped, byte for byte.

#![cfg(unix)]

use ddl::RunDirectory;
use ddl::network::Objective;
use ddl_tests::folder_contents::{self, Contents};
use ddl_tests::program::{self, Finished};
use ddl_tests::training_result;
use std::collections::hash_map::RandomState;
use std::hash::BuildHasher as _;
use std::io::{BufRead as _, BufReader, Lines};
use std::path::Path;
use std::process::{Child, ChildStdout, Command, Stdio};
use std::time::Duration;

/// Steps of the proposal network, before those of the forecasting network.
const GOAL_STEPS: usize = 12;
/// 3 epochs of 8 steps.
const STEPS: usize = 24;
const TRAIN: &str = "train --convention simulated --fold doorway --epochs 3 --train-walkers 128 \
                     --batch-walkers 16 --proposal-steps 12 --threads 1 --progress json --out run";

/// Training under way, and what it tells.
struct Training {
    child: Child,
    lines: Lines<BufReader<ChildStdout>>,
}

impl Training {
    fn start(folder: &Path) -> Self {
        let mut child = program::command(folder, TRAIN)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let lines = BufReader::new(child.stdout.take().unwrap()).lines();
        Self { child, lines }
    }

    /// Waits until so many steps were told.
    fn wait_for(&mut self, steps: usize) {
        for _ in 0..steps {
            self.lines.next().unwrap().unwrap();
        }
    }

    /// Ends it with no chance to save anything.
    fn kill(mut self) {
        self.child.kill().unwrap();
        let status = self.child.wait().unwrap();
        assert_eq!(status.code(), None, "it had ended before it was killed");
    }

    /// Asks it to end, and waits.
    fn signal(self, name: &str) -> Finished {
        let Self { child, lines } = self;
        let id = child.id().to_string();
        let sent = Command::new("kill").args(["-s", name, &id]).status();
        assert!(sent.unwrap().success());
        // read on, or it would wait for room in the pipe
        lines.for_each(|line| drop(line.unwrap()));
        let output = child.wait_with_output().unwrap();
        Finished::new(format!("train, {name}"), &output)
    }
}

/// A whole run's files without the one that holds seconds.
fn finish(folder: &Path) -> Contents {
    let rest = program::run(folder, TRAIN).succeeds();
    let last = rest.lines().last().unwrap_or_default();
    let all = format!("\"done\":{STEPS},\"total\":{STEPS}");
    assert!(rest.is_empty() || last.contains(&all), "ended at {last}");
    training_result::of(&folder.join("run"))
}

/// Trains with interruptions and compares with training that had none.
fn interrupted_equals_whole(interrupt: impl FnOnce(&Path)) {
    let [whole, stopped] = [0, 1].map(|_| tempfile::tempdir().unwrap());
    let expected = finish(whole.path());
    // of the recommended recipe: whole walks to goals that the stage before estimates
    let config = RunDirectory::new(whole.path().join("run"))
        .config()
        .unwrap();
    assert_eq!(config.training.objective, Objective::Walk);
    assert!(expected.contains_key(Path::new("model.safetensors")));
    interrupt(stopped.path());
    let model = stopped.path().join("run/model.safetensors");
    assert!(
        !model.exists(),
        "the run had ended before it was interrupted"
    );
    // nothing is left of what a killed process was writing when it was killed
    let found = finish(stopped.path());
    assert_eq!(
        folder_contents::differences(&expected, &found),
        Vec::<String>::new()
    );
}

/// Ctrl-C: the step under way is finished, everything saved, exit code 130.
#[test]
fn an_interrupted_run_goes_on_to_the_same_bytes() {
    interrupted_equals_whole(|folder| {
        let in_the_first_stage = GOAL_STEPS / 2;
        for steps in [in_the_first_stage, GOAL_STEPS - in_the_first_stage + 8, 3] {
            let mut training = Training::start(folder);
            training.wait_for(steps);
            let finished = training.signal("INT");
            assert_eq!(finished.code, Some(130), "{finished:#?}");
            for told in ["run, ", " batches", "saved", "the same command"] {
                assert!(finished.stderr.contains(told), "{finished:#?}");
            }
            let state = if steps == in_the_first_stage {
                "run/proposal-state.safetensors"
            } else {
                "run/optimizer.safetensors"
            };
            assert!(folder.join(state).is_file());
        }
    });
}

/// A supervisor's polite request to end is one as well.
#[test]
fn a_terminated_run_saves_too() {
    let folder = tempfile::tempdir().unwrap();
    let mut training = Training::start(folder.path());
    training.wait_for(GOAL_STEPS + 2);
    let finished = training.signal("TERM");
    assert_eq!(finished.code, Some(130), "{finished:#?}");
    assert!(folder.path().join("run/optimizer.safetensors").is_file());
}

/// Killed three times at moments that differ from run to run, once while it prepares and twice while
/// it trains or saves: no file is ever half written, and the end is the same.
#[test]
fn a_killed_run_goes_on_to_the_same_bytes() {
    interrupted_equals_whole(|folder| {
        let random = RandomState::new().hash_one("moments");
        let before_the_first_step = Duration::from_millis(random % 400);
        eprintln!("killed after {before_the_first_step:?}");
        let training = Training::start(folder);
        std::thread::sleep(before_the_first_step);
        training.kill();
        for part in [random >> 16, random >> 32] {
            // at most 8 steps and a moment, so that it cannot be through after two
            let (steps, moment) = (part % 8 + 1, Duration::from_micros(part / 5 % 90_000));
            eprintln!("killed {moment:?} after step {steps} of the attempt");
            let mut training = Training::start(folder);
            training.wait_for(usize::try_from(steps).unwrap());
            std::thread::sleep(moment);
            training.kill();
        }
    });
}
