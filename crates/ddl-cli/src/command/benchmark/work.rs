//! Runs the tasks of a plan in parallel, in processes of the program.

use crate::command::benchmark::child::{self, BEAT};
use crate::command::benchmark::plan::{BenchmarkPlan, Task};
use crate::command::benchmark::record::Record;
use crate::interrupt::Interrupt;
use crate::progress::ProgressLine;
use anyhow::{Context as _, anyhow, ensure};
use ddl::data::remove_temporary_files;
use ddl::{DeviceChoice, RunDirectory};
use std::cell::Cell;
use std::ffi::OsString;
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::Write as _;
use std::path::Path;
use std::process::{Command, ExitStatus, Stdio};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use std::thread;
use std::time::Instant;

/// Default number of tasks that share one graphics card: the folds of a convention. Their kernels are small, and each
/// needs one or two gigabytes of memory.
const ON_ONE_CARD: usize = 5;

const LAST_LINES: usize = 8;

/// Runs up to `jobs` tasks at a time, each in processes with `threads` threads.
#[derive(Debug)]
pub(super) struct Workers {
    pub(super) program: Vec<OsString>,
    pub(super) jobs: usize,
    pub(super) threads: usize,
    pub(super) commit: String,
}

#[derive(Debug, Clone, PartialEq)]
pub(super) enum TaskEnd {
    /// Trained and scored now.
    Finished { seconds: f64 },
    /// An earlier run finished it.
    Kept,
    /// `reason` holds the last lines of the log.
    Failed { reason: String },
    /// Stopped by a signal, or not begun; a later run resumes it.
    Interrupted,
}

#[derive(Debug, Clone, Copy)]
pub(super) enum Event<'a> {
    Started,
    /// The part of the task that is done, from 0 to 1, and the current step.
    Advanced(f64, &'a str),
    Ended(&'a TaskEnd),
}

pub(super) type Watcher<'a> = &'a (dyn Fn(&Task, Event<'_>) + Sync);

/// The number of parallel processes and the threads of each. Default: on the CPU one process for each core; on CUDA all
/// tasks up to five, since a training mostly waits for its next kernel launch.
pub(super) fn side_by_side(asked: Option<usize>, device: DeviceChoice, cores: usize, tasks: usize) -> (usize, usize) {
    let jobs = asked.unwrap_or(match device {
        DeviceChoice::Cuda => tasks.clamp(1, ON_ONE_CARD),
        DeviceChoice::Cpu | DeviceChoice::Auto => cores,
    });
    (jobs, (cores / jobs.max(1)).max(1))
}

impl Workers {
    /// The end of each task, in the plan's order. After a request to stop no task starts, and running tasks save their
    /// state.
    pub(super) fn run(
        &self,
        plan: &BenchmarkPlan,
        out: &Path,
        watch: Watcher<'_>,
        interrupt: &Interrupt,
    ) -> Vec<TaskEnd> {
        let next = AtomicUsize::new(0);
        let ends = Mutex::new(vec![TaskEnd::Interrupted; plan.tasks.len()]);
        let work = || {
            while interrupt.wishes() == 0 {
                let index = next.fetch_add(1, Ordering::SeqCst);
                let Some(task) = plan.tasks.get(index) else {
                    break;
                };
                let end = self.run_task(plan, task, out, watch, interrupt);
                watch(task, Event::Ended(&end));
                ends.lock().unwrap_or_else(PoisonError::into_inner)[index] = end;
            }
        };
        thread::scope(|scope| {
            for _ in 0..self.jobs.min(plan.tasks.len()) {
                scope.spawn(work);
            }
        });
        ends.into_inner().unwrap_or_else(PoisonError::into_inner)
    }

    pub(super) fn run_task(
        &self,
        plan: &BenchmarkPlan,
        task: &Task,
        out: &Path,
        watch: Watcher<'_>,
        interrupt: &Interrupt,
    ) -> TaskEnd {
        if Record::of(task, out).is_some() {
            return TaskEnd::Kept;
        }
        watch(task, Event::Started);
        let end = self.train_and_score(plan, task, out, watch, interrupt);
        end.unwrap_or_else(|error| failure(task, out, &format!("{error:#}")))
    }

    fn train_and_score(
        &self,
        plan: &BenchmarkPlan,
        task: &Task,
        out: &Path,
        watch: Watcher<'_>,
        interrupt: &Interrupt,
    ) -> anyhow::Result<TaskEnd> {
        let mut log = open_log(&task.folder(out))?;
        // Processes of an earlier benchmark that was killed may still run; they end by themselves.
        while is_held(&log) {
            if interrupt.wishes() > 0 {
                return Ok(TaskEnd::Interrupted);
            }
            let waits = "waits for a process of an earlier benchmark";
            watch(task, Event::Advanced(0.0, waits));
            thread::sleep(BEAT);
        }
        if Record::of(task, out).is_some() {
            return Ok(TaskEnd::Kept);
        }
        // No other process writes there now; the program itself cleans the folder of the run.
        remove_temporary_files(&task.folder(out));
        let start = Instant::now();
        let other = plan.with_same_goals(task);
        if let Some(other) = other.filter(|task| Record::of(task, out).is_some()) {
            let (here, there) = (task.run_folder(out), other.run_folder(out));
            RunDirectory::new(here).copy_goals_from(&RunDirectory::new(there)).map_err(|error| anyhow!("{error}"))?;
        }
        let pace = plan.pace(task);
        // The progress of a task never decreases.
        let reached = Cell::new(0.0_f64);
        let tell = |stage: &str, fraction: f64, message: &str| {
            reached.set(reached.get().max(pace.at(stage, fraction)));
            watch(task, Event::Advanced(reached.get(), &format!("{stage} {message}")));
        };
        for arguments in
            [plan.train_arguments(task, out, self.threads), plan.evaluate_arguments(task, out, self.threads)]
        {
            let ended = self.run_step(&mut log, &arguments, interrupt, &tell);
            // A process that was asked to stop has saved its state and ended.
            if interrupt.wishes() > 0 {
                return Ok(TaskEnd::Interrupted);
            }
            let status = ended?;
            ensure!(status.success(), "`ddl {}` ended with {status}", arguments[0]);
        }
        let seconds = start.elapsed().as_secs_f64();
        Record::write(task, out, seconds)?;
        Ok(TaskEnd::Finished { seconds })
    }

    /// Runs the program once. Its standard error goes to the log of the task. With the open file it holds the lock of
    /// the log until it ends, even if this process ends earlier.
    fn run_step(
        &self,
        log: &mut File,
        arguments: &[String],
        interrupt: &Interrupt,
        tell: &dyn Fn(&str, f64, &str),
    ) -> anyhow::Result<ExitStatus> {
        writeln!(log, "$ ddl {}", arguments.join(" ")).context("cannot write the log")?;
        let errors = log.try_clone().context("cannot share the log")?;
        let (program, leading) = self.program.split_first().context("no program to run")?;
        let mut command = Command::new(program);
        command.args(leading).args(arguments).env("DDL_COMMIT", &self.commit).stderr(Stdio::from(errors));
        child::run(&mut command, interrupt, |line| {
            match serde_json::from_str::<ProgressLine<'_>>(line) {
                Ok(progress) if progress.total > 0 => {
                    let fraction = (progress.done as f64 / progress.total as f64).min(1.0);
                    tell(&progress.stage, fraction, &progress.message);
                }
                // Other lines go to the log; a failure to write them does not harm the task.
                _ => drop(writeln!(log, "{line}")),
            }
        })
    }
}

fn open_log(folder: &Path) -> anyhow::Result<File> {
    let path = folder.join("log.txt");
    fs::create_dir_all(folder)
        .and_then(|()| OpenOptions::new().create(true).append(true).open(&path))
        .with_context(|| format!("cannot open {}", path.display()))
}

/// Whether a process of an earlier benchmark still writes into the log. If not, this process has locked it, and the
/// processes that it starts share the lock with the open file.
fn is_held(log: &File) -> bool {
    matches!(log.try_lock(), Err(TryLockError::WouldBlock))
}

fn failure(task: &Task, out: &Path, what: &str) -> TaskEnd {
    let log = task.folder(out).join("log.txt");
    let text = fs::read(&log).unwrap_or_default();
    let text = String::from_utf8_lossy(&text);
    let lines: Vec<&str> = text.lines().collect();
    let last = &lines[lines.len().saturating_sub(LAST_LINES)..];
    let end = last.join("\n    ");
    TaskEnd::Failed { reason: format!("{what}; the end of {}:\n    {end}", log.display()) }
}

#[cfg(test)]
#[path = "work_tests.rs"]
mod tests;
