//! The script of a task with stand-ins for `ddl` and `scontrol`. `cargo xtask nightly cluster` tests it with a real
//! Slurm.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use super::*;
use rustix::process::{Pid, Signal, kill_process};
use std::process::{Child, Stdio};
use std::thread;
use std::time::Duration;

/// Runs until it gets SIGTERM; with `code`, ends at once.
const PROGRAM: &str = r#"
[ -n "$code" ] || trap 'exit 130' TERM
echo "$$ $*" > begun.writing; mv begun.writing begun
[ -n "$code" ] && exit "$code"
while :; do sleep 0.02; done
"#;

struct QueuedTask {
    folder: tempfile::TempDir,
    script: Child,
}

impl QueuedTask {
    fn begin(variables: &[(&str, &str)]) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let put = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
        put("task.sh", include_str!("task.sh"));
        put("program", PROGRAM);
        // A file that another test's process may hold open cannot be executed, so a function stands in for the program.
        put("scontrol.sh", "scontrol() { echo \"$*\" > \"$folder/asked\"; }\n");
        let script = "folder=$PWD; . ./scontrol.sh; . ./task.sh";
        // A shell cannot trap a signal that was ignored when it began, as in a background job.
        let script = Command::new("env")
            .args(["--default-signal=INT", "sh", "-c", script])
            .args("task.sh 1000 . sh program benchmark".split(' '))
            .current_dir(folder.path())
            .envs([("SLURM_ARRAY_TASK_ID", "7"), ("SLURM_JOB_ID", "42"), ("code", "")])
            .envs(variables.iter().copied())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        Self { folder, script }
    }

    /// The program's process, and its arguments.
    fn begun(&self) -> (i32, String) {
        loop {
            if let Ok(line) = fs::read_to_string(self.folder.path().join("begun")) {
                let (id, arguments) = line.trim().split_once(' ').unwrap();
                return (id.parse().unwrap(), arguments.to_owned());
            }
            thread::sleep(Duration::from_millis(5));
        }
    }

    /// Exit code, arguments of the `scontrol` call, standard error.
    fn end(self) -> (Option<i32>, Option<String>, String) {
        let output = self.script.wait_with_output().unwrap();
        let asked = fs::read_to_string(self.folder.path().join("asked")).ok();
        let message = String::from_utf8(output.stderr).unwrap();
        (output.status.code(), asked, message)
    }
}

fn signal(process: i32, signal: Signal) {
    kill_process(Pid::from_raw(process).unwrap(), signal).unwrap();
}

#[test]
fn the_script_ends_with_the_exit_code_of_the_program() {
    for code in ["0", "1", "130"] {
        let task = QueuedTask::begin(&[("code", code)]);
        assert_eq!(task.begun().1, "benchmark --task 1007");
        let ended = task.end();
        assert_eq!(ended, (code.parse().ok(), None, String::new()));
    }
}

#[test]
fn a_warned_task_saves_and_is_queued_again_and_a_cancelled_one_is_not() {
    let warned = QueuedTask::begin(&[]);
    warned.begun();
    signal(warned.script.id().cast_signed(), Signal::INT);
    let (code, asked, message) = warned.end();
    assert_eq!((code, asked.as_deref()), (Some(0), Some("requeue 42\n")), "{message}");
    // Slurm sends SIGTERM to every process of a job.
    let cancelled = QueuedTask::begin(&[]);
    let (program, _) = cancelled.begun();
    signal(cancelled.script.id().cast_signed(), Signal::TERM);
    signal(program, Signal::TERM);
    let (code, asked, message) = cancelled.end();
    assert_eq!((code, asked), (Some(130), None), "{message}");
}

#[test]
fn a_time_limit_that_is_too_short_is_named() {
    for times in ["3", "100"] {
        let task = QueuedTask::begin(&[("SLURM_RESTART_COUNT", times)]);
        task.begun();
        signal(task.script.id().cast_signed(), Signal::INT);
        let (code, asked, message) = task.end();
        assert_eq!((code, asked), (Some(1), None));
        assert!(
            message.contains("too short") && message.contains("SBATCH_TIMELIMIT"),
            "{message}"
        );
    }
}

#[test]
fn an_error_names_the_program_and_repeats_its_message() {
    let mut command = Command::new("sh");
    let error = answer(command.args(["-c", "echo no such partition >&2; exit 3"])).unwrap_err();
    let message = error.to_string();
    assert!(
        message.contains("`sh -c") && message.contains("no such partition") && message.contains('3'),
        "{message}"
    );
    let error = answer(&mut Command::new("no-such-squeue")).unwrap_err();
    assert!(error.to_string().contains("needs Slurm's programs"), "{error:#}");
}
