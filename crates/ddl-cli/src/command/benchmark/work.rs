//! The tasks of a plan, worked off side by side in processes of the program.

use super::child::{self, BEAT};
use super::plan::{Plan, Task};
use super::record::Record;
use crate::interrupt::Interrupt;
use crate::progress::ProgressLine;
use anyhow::Context as _;
use ddl::data::remove_half_written;
use ddl::{DeviceChoice, RunDirectory};
use std::ffi::OsString;
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::Write as _;
use std::path::Path;
use std::process::{Command, ExitStatus, Stdio};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use std::thread;
use std::time::Instant;

/// Tasks that share one graphics card when nobody says how many: the folds of a convention. Their kernels are small
/// and their memory is a gigabyte or two each.
const ON_ONE_CARD: usize = 5;

/// Share of a training that its first stage, the goals, is shown as.
const GOALS: f64 = 0.15;

const LAST_LINES: usize = 8;

/// Works off up to `jobs` tasks at a time, each in processes with `threads` threads.
#[derive(Debug)]
pub(super) struct Workers {
    pub(super) program: Vec<OsString>,
    pub(super) jobs: usize,
    pub(super) threads: usize,
    pub(super) commit: String,
}

#[derive(Debug, Clone, PartialEq)]
pub(super) enum End {
    /// Trained and scored now.
    Finished { seconds: f64 },
    /// An earlier run finished it.
    Kept,
    /// With the last lines of the log.
    Failed { reason: String },
    /// Stopped from outside, or not begun; a later run goes on from here.
    Interrupted,
}

#[derive(Debug, Clone, Copy)]
pub(super) enum Event<'a> {
    Started,
    /// Which part of the task is done, from 0 to 1, and what it is at.
    Advanced(f64, &'a str),
    Ended(&'a End),
}

pub(super) type Watch<'a> = &'a (dyn Fn(&Task, Event<'_>) + Sync);

/// Processes side by side and the threads of each. When nobody asks for a number: on the CPU one process a core; on CUDA all tasks up to five,
/// since a training waits for its next launch most of the time.
pub(super) fn side_by_side(
    asked: Option<usize>,
    device: DeviceChoice,
    cores: usize,
    tasks: usize,
) -> (usize, usize) {
    let jobs = asked.unwrap_or(match device {
        DeviceChoice::Cuda => tasks.clamp(1, ON_ONE_CARD),
        DeviceChoice::Cpu | DeviceChoice::Auto => cores,
    });
    (jobs, (cores / jobs.max(1)).max(1))
}

impl Workers {
    /// How each task ended, in the plan's order. After a wish to stop none begins, and running ones are asked to save.
    pub(super) fn run(
        &self,
        plan: &Plan,
        out: &Path,
        watch: Watch<'_>,
        interrupt: &Interrupt,
    ) -> Vec<End> {
        let next = AtomicUsize::new(0);
        let ends = Mutex::new(vec![End::Interrupted; plan.tasks.len()]);
        let work = || {
            // Tasks lie longest first, so taking them in order fills the cores best.
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
        plan: &Plan,
        task: &Task,
        out: &Path,
        watch: Watch<'_>,
        interrupt: &Interrupt,
    ) -> End {
        if Record::of(task, out).is_some() {
            return End::Kept;
        }
        watch(task, Event::Started);
        let mut log = match open_log(&task.folder(out)) {
            Ok(log) => log,
            Err(error) => return failure(task, out, &format!("{error:#}")),
        };
        // Whoever killed an earlier benchmark may have left its processes to themselves: they end by themselves.
        while is_held(&log) {
            if interrupt.wishes() > 0 {
                return End::Interrupted;
            }
            let waits = "waits for a process of an earlier benchmark";
            watch(task, Event::Advanced(0.0, waits));
            thread::sleep(BEAT);
        }
        if Record::of(task, out).is_some() {
            return End::Kept;
        }
        // Nobody else is at work there now; the folder of the run is the program's own.
        remove_half_written(&task.folder(out));
        let start = Instant::now();
        if let Some(other) = plan
            .with_same_goals(task)
            .filter(|task| Record::of(task, out).is_some())
        {
            let (here, there) = (task.run_folder(out), other.run_folder(out));
            if let Err(error) = RunDirectory::new(here).take_goals_of(&RunDirectory::new(there)) {
                return failure(task, out, &error.to_string());
            }
        }
        let train = task.train_cost / task.cost();
        let steps = [
            (plan.train_arguments(task, out, self.threads), 0.0, train),
            (plan.goals_arguments(task, out, self.threads), train, train),
            (plan.evaluate_arguments(task, out, self.threads), train, 1.0),
        ];
        for (arguments, from, to) in steps {
            let tell = |fraction: f64, message: &str| {
                watch(
                    task,
                    Event::Advanced(from + (to - from) * fraction, message),
                );
            };
            match self.run_step(&mut log, &arguments, interrupt, &tell) {
                Ok(status) if status.success() => {}
                // A process that was asked to stop has saved and left.
                _ if interrupt.wishes() > 0 => return End::Interrupted,
                Ok(status) => {
                    let step = arguments.first().map_or("", String::as_str);
                    return failure(task, out, &format!("`ddl {step}` ended with {status}"));
                }
                Err(error) => return failure(task, out, &format!("{error:#}")),
            }
            if interrupt.wishes() > 0 {
                return End::Interrupted;
            }
        }
        let seconds = start.elapsed().as_secs_f64();
        match Record::write(task, out, seconds) {
            Ok(()) => End::Finished { seconds },
            Err(error) => failure(task, out, &format!("{error:#}")),
        }
    }

    /// Runs the program once; its standard error goes to the task's log, which it so holds until it ends, whatever becomes of this process.
    fn run_step(
        &self,
        log: &mut File,
        arguments: &[String],
        interrupt: &Interrupt,
        tell: &dyn Fn(f64, &str),
    ) -> anyhow::Result<ExitStatus> {
        writeln!(log, "$ ddl {}", arguments.join(" ")).context("the log cannot be written")?;
        let errors = log.try_clone().context("the log cannot be shared")?;
        let (program, leading) = self.program.split_first().context("there is no program")?;
        let mut command = Command::new(program);
        command
            .args(leading)
            .args(arguments)
            .env("DDL_COMMIT", &self.commit)
            .stderr(Stdio::from(errors));
        let mut reached = 0.0_f64;
        child::run(&mut command, interrupt, |line| {
            match serde_json::from_str::<ProgressLine<'_>>(line) {
                Ok(progress) if progress.total > 0 => {
                    // A program that begins a new stage counts from nothing again; the whole never
                    // goes back.
                    let fraction = (progress.done as f64 / progress.total as f64).min(1.0);
                    reached = reached.max(match progress.stage.as_ref() {
                        "goals" => GOALS * fraction,
                        "train" => GOALS + (1.0 - GOALS) * fraction,
                        _ => fraction,
                    });
                    tell(reached, &format!("{} {}", progress.stage, progress.message));
                }
                // Anything else is for the log, which may fail without harm to the task.
                _ => drop(writeln!(log, "{line}")),
            }
        })
    }
}

fn open_log(folder: &Path) -> anyhow::Result<File> {
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
#[path = "work_tests.rs"]
mod tests;
