//! Tasks as processes on this machine.

use std::ffi::OsString;
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{BufRead as _, BufReader, Write as _};
use std::path::{Path, PathBuf};
use std::process::{Command, ExitStatus, Stdio};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use std::thread;
use std::time::Instant;

use anyhow::{Context, Result};
use serde::Deserialize;

use super::child::{BEAT, Children};
use super::executor::{End, Executor, Stop, Watch};
use super::plan::{Plan, Task};
use super::record;
use crate::whole_file;

/// Share of a training that its first stage, the goals, is shown as.
const GOALS: f64 = 0.15;

/// Lines of a log that are shown when a task fails.
const LAST_LINES: usize = 8;

/// Runs up to `jobs` tasks at a time, each in a process of the program `ddl`.
#[derive(Debug)]
pub(crate) struct Local {
    program: PathBuf,
    /// What stands before the arguments of a task.
    leading: Vec<OsString>,
    jobs: usize,
    threads: usize,
    /// What results name as the code that made them.
    commit: String,
    children: Children,
}

impl Local {
    /// A program to which each task's arguments are handed; `threads` is what each process computes with: `jobs` times `threads` should not be more
    /// than the machine's cores.
    pub(crate) fn new(program: PathBuf, jobs: usize, threads: usize) -> Self {
        Self {
            program,
            leading: Vec::new(),
            jobs,
            threads,
            commit: "unknown".to_owned(),
            children: Children::default(),
        }
    }

    /// Names the commit in all results.
    pub(crate) fn of_commit(self, commit: String) -> Self {
        Self { commit, ..self }
    }

    /// Puts arguments before those of every task, as in `nice ddl`.
    #[cfg(test)]
    fn leading(self, arguments: Vec<OsString>) -> Self {
        Self {
            leading: arguments,
            ..self
        }
    }
}

impl Executor for Local {
    fn run(&self, plan: &Plan, out: &Path, watch: &dyn Watch, stop: &Stop) -> Result<Vec<End>> {
        let next = AtomicUsize::new(0);
        let ends = Mutex::new(vec![End::Interrupted; plan.tasks.len()]);
        let all_ended = AtomicBool::new(false);
        thread::scope(|scope| {
            let forwarder = scope.spawn(|| {
                while !all_ended.load(Ordering::SeqCst) {
                    self.children.forward(stop);
                    thread::sleep(BEAT);
                }
            });
            let workers: Vec<_> = (0..self.jobs.min(plan.tasks.len()))
                .map(|_| {
                    scope.spawn(|| {
                        // Tasks lie longest first, so taking them in order fills the cores best.
                        while !stop.is_requested() {
                            let index = next.fetch_add(1, Ordering::SeqCst);
                            let Some(task) = plan.tasks.get(index) else {
                                break;
                            };
                            let end = self.run_task(plan, task, out, watch, stop);
                            watch.ended(task, &end);
                            ends.lock().unwrap_or_else(PoisonError::into_inner)[index] = end;
                        }
                    })
                })
                .collect();
            let panicked = workers
                .into_iter()
                .filter_map(|worker| worker.join().err())
                .count();
            all_ended.store(true, Ordering::SeqCst);
            let _ = forwarder.join();
            anyhow::ensure!(
                panicked == 0,
                "{panicked} workers panicked: this is a bug of xtask"
            );
            Ok(())
        })?;
        Ok(ends.into_inner().unwrap_or_else(PoisonError::into_inner))
    }
}

/// One line of a child's standard output.
#[derive(Debug, Deserialize)]
struct ProgressLine {
    stage: String,
    done: f64,
    total: f64,
    #[serde(default)]
    message: String,
}

impl Local {
    fn run_task(
        &self,
        plan: &Plan,
        task: &Task,
        out: &Path,
        watch: &dyn Watch,
        stop: &Stop,
    ) -> End {
        if record::is_finished(task, out) {
            return End::Kept;
        }
        watch.started(task);
        let mut log = match open_log(&task.folder(out)) {
            Ok(log) => log,
            Err(error) => return failure(task, out, &format!("{error:#}")),
        };
        // Whoever killed an earlier benchmark may have left its processes to themselves: they end by themselves.
        while is_held(&log) {
            if stop.is_requested() {
                return End::Interrupted;
            }
            watch.advanced(task, 0.0, "waits for a process of an earlier benchmark");
            thread::sleep(BEAT);
        }
        // Nobody else is at work there now; the folder of the run is the program's own.
        whole_file::remove_half_written(&task.folder(out));
        let start = Instant::now();
        let train = task.train_cost / task.cost();
        let steps = [
            (plan.train_arguments(task, out, self.threads), 0.0, train),
            (plan.goals_arguments(task, out, self.threads), train, train),
            (plan.evaluate_arguments(task, out, self.threads), train, 1.0),
        ];
        for (arguments, from, to) in steps {
            let tell = |fraction: f64, message: &str| {
                watch.advanced(task, from + (to - from) * fraction, message);
            };
            match self.run_step(&mut log, &arguments, &tell) {
                Ok(status) if status.success() => {}
                // A child that was asked to stop has saved and left.
                _ if stop.is_requested() => return End::Interrupted,
                Ok(status) => {
                    let step = arguments.first().map_or("", String::as_str);
                    return failure(task, out, &format!("`ddl {step}` ended with {status}"));
                }
                Err(error) => return failure(task, out, &format!("{error:#}")),
            }
            if stop.is_requested() {
                return End::Interrupted;
            }
        }
        let seconds = start.elapsed().as_secs_f64();
        match record::write(task, out, seconds) {
            Ok(()) => End::Finished { seconds },
            Err(error) => failure(task, out, &format!("{error:#}")),
        }
    }

    /// Runs the program once; its standard error goes to the task's log, which it so holds until it ends, whatever becomes of this process.
    fn run_step(
        &self,
        log: &mut File,
        arguments: &[String],
        tell: &dyn Fn(f64, &str),
    ) -> Result<ExitStatus> {
        writeln!(log, "$ ddl {}", arguments.join(" ")).context("the log cannot be written")?;
        let errors = log.try_clone().context("the log cannot be shared")?;
        let mut command = Command::new(&self.program);
        command
            .args(&self.leading)
            .args(arguments)
            .env("OMP_NUM_THREADS", self.threads.to_string())
            .env("RAYON_NUM_THREADS", self.threads.to_string())
            .env("DDL_COMMIT", &self.commit)
            .stderr(Stdio::from(errors));
        let (id, stdout) = self.children.start(&mut command)?;
        let mut reached = 0.0_f64;
        for line in BufReader::new(stdout).lines() {
            let Ok(line) = line else { break };
            match serde_json::from_str::<ProgressLine>(&line) {
                Ok(progress) if progress.total > 0.0 => {
                    // A program that begins a new stage counts from nothing again; the whole never
                    // goes back.
                    let fraction = (progress.done / progress.total).clamp(0.0, 1.0);
                    reached = reached.max(match progress.stage.as_str() {
                        "goals" => GOALS * fraction,
                        "train" => GOALS + (1.0 - GOALS) * fraction,
                        _ => fraction,
                    });
                    tell(reached, &format!("{} {}", progress.stage, progress.message));
                }
                // Anything else is for the log, which may fail without harm to the task.
                _ => drop(writeln!(log, "{line}")),
            }
        }
        self.children.wait(id)
    }
}

fn open_log(folder: &Path) -> Result<File> {
    let path = folder.join("log.txt");
    fs::create_dir_all(folder)
        .and_then(|()| OpenOptions::new().create(true).append(true).open(&path))
        .with_context(|| format!("{} cannot be opened", path.display()))
}

/// Whether a process of an earlier benchmark still writes into the log; else it is this process's, and that of the processes it starts: they
/// share the lock with the file that they write to.
fn is_held(log: &File) -> bool {
    matches!(log.try_lock(), Err(TryLockError::WouldBlock))
}

fn failure(task: &Task, out: &Path, what: &str) -> End {
    let log = task.folder(out).join("log.txt");
    let text = fs::read(&log).unwrap_or_default();
    let text = String::from_utf8_lossy(&text);
    let lines: Vec<&str> = text.lines().collect();
    let last = &lines[lines.len().saturating_sub(LAST_LINES)..];
    let end = last.join("\n    ");
    End::Failed {
        reason: format!("{what}; the end of {}:\n    {end}", log.display()),
    }
}

#[cfg(test)]
#[path = "local_tests.rs"]
mod tests;
