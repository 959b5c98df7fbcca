//! The tasks of a plan as jobs of Slurm. What is finished is seen in the plan's folder, what is alive by `squeue`; a job belongs to the
//! plan in whose folder it was begun, so that nothing has to be remembered of it. Nothing here needs `sacct`.

mod array;
mod queue;

use super::display::Display;
use super::plan::Plan;
use super::record::Record;
use super::this_program;
use super::work::{End, Event};
use crate::interrupt::Interrupt;
use crate::output::shell_word;
use crate::telling::tell;
use anyhow::{Context as _, ensure};
use ddl::DdlError;
use ddl::data::write_whole;
use queue::Job;
use std::collections::BTreeMap;
use std::ffi::{OsStr, OsString};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::thread;
use std::time::{Duration, Instant};

pub(super) use queue::ids;

/// How often the scheduler is asked.
const EVERY: Duration = Duration::from_secs(3);

/// How often a wish to stop is looked for.
const BEAT: Duration = Duration::from_millis(50);

#[derive(Debug)]
pub(super) struct Slurm {
    /// The plan's folder, in the one spelling that `squeue` gives back.
    out: PathBuf,
    /// What the scripts of all jobs are given: the folder to be in, the program and its arguments.
    arguments: Vec<OsString>,
}

impl Slurm {
    pub(super) fn new(out: &Path, commit: &str) -> anyhow::Result<Self> {
        let unreadable = || format!("{} cannot be read", out.display());
        let out = out.canonicalize().with_context(unreadable)?;
        let here = std::env::current_dir().context("the current folder cannot be read")?;
        let mut arguments: Vec<OsString> = vec![here.into(), this_program()?.into()];
        arguments.extend(["benchmark", "--commit", commit, "--out"].map(OsString::from));
        arguments.push(out.clone().into());
        Ok(Self { out, arguments })
    }

    /// The jobs of this folder that are not over.
    pub(super) fn queue(&self) -> anyhow::Result<Vec<Job>> {
        let mut squeue = Command::new("squeue");
        // Filters that somebody has set for themselves would hide jobs.
        for (name, _) in std::env::vars_os() {
            if name.to_string_lossy().starts_with("SQUEUE_") {
                squeue.env_remove(name);
            }
        }
        squeue.args(["--me", "--noheader", "--array", "--format", queue::FORMAT]);
        Ok(queue::jobs_in(&self.out, &answer(&mut squeue)?))
    }

    /// Submits the tasks that are not finished, `jobs` of them at a time, and what makes the report when they are over.
    pub(super) fn submit(
        &self,
        plan: &Plan,
        jobs: Option<usize>,
        threads: usize,
    ) -> anyhow::Result<()> {
        let unfinished: Vec<usize> = (0..plan.tasks.len())
            .filter(|&index| Record::of(&plan.tasks[index], &self.out).is_none())
            .collect();
        if unfinished.is_empty() {
            return Ok(());
        }
        let logs = self.out.join("slurm");
        fs::create_dir_all(&logs).with_context(|| format!("cannot make {}", logs.display()))?;
        let config = answer(Command::new("scontrol").args(["show", "config"]))?;
        let at_a_time = jobs.map_or_else(String::new, |jobs| format!("%{jobs}"));
        let mut submitted: Vec<String> = Vec::new();
        for array in array::arrays(&unfinished, array::longest(&config)?) {
            let mut options = vec![
                format!("--job-name={}{}", queue::TASKS, array.first),
                format!("--array={}{at_a_time}", array.indices),
                format!("--cpus-per-task={threads}"),
            ];
            // At a time: of all arrays together.
            if let (Some(_), Some(before)) = (jobs, submitted.last()) {
                options.push(format!("--dependency=afterany:{before}"));
            }
            let first = [OsString::from(array.first.to_string())];
            let script = ("task.sh", include_str!("slurm/task.sh"));
            let id = self.sbatch(&options, script, &first).with_context(|| {
                let before = submitted.join(" ");
                let some = format!("not all tasks are submitted (jobs {before} are; the same command later submits the rest)");
                if submitted.is_empty() { "no task is submitted".to_owned() } else { some }
            })?;
            submitted.push(id);
        }
        let options = [
            format!("--job-name={}", queue::REPORT),
            format!("--dependency=afterany:{}", submitted.join(":")),
            "--cpus-per-task=1".to_owned(),
        ];
        let script = ("report.sh", include_str!("slurm/report.sh"));
        let report = self.sbatch(&options, script, &[]);
        let report = report.context("the tasks are submitted, but not what makes the report: the same command, or `--collect`, does it")?;
        tell(format_args!(
            "submitted: {} of {} tasks with {threads} threads each as job {}, and job {report}, which then makes the report; logs are in {}",
            unfinished.len(),
            plan.tasks.len(),
            submitted.join(" "),
            logs.display()
        ));
        tell(format_args!(
            "Ctrl-C leaves the jobs to themselves, and the same command watches them again; `scancel {} {report}` cancels them",
            submitted.join(" ")
        ));
        Ok(())
    }

    /// The job's number.
    fn sbatch(
        &self,
        options: &[String],
        (name, script): (&str, &str),
        first: &[OsString],
    ) -> anyhow::Result<String> {
        let file = self.out.join("slurm").join(name);
        let unwritable = || format!("cannot write {}", file.display());
        write_whole(&file, script.as_bytes()).with_context(unwritable)?;
        let mut sbatch = Command::new("sbatch");
        sbatch
            .args(["--parsable", "--chdir"])
            .arg(&self.out)
            .args(options)
            .arg(&file)
            .args(first)
            .args(&self.arguments);
        let told = answer(&mut sbatch)?;
        // With more than one cluster: `number;cluster`.
        let id = told.trim().split(';').next().unwrap_or_default();
        ensure!(
            !id.is_empty() && id.bytes().all(|byte| byte.is_ascii_digit()),
            "`sbatch` did not print the number of a job, but {told:?}"
        );
        Ok(id.to_owned())
    }

    /// Tells what becomes of the tasks until no job of this folder is alive.
    ///
    /// # Errors
    /// [`DdlError::Interrupted`] after a wish to stop, which the jobs do not hear of.
    pub(super) fn watch(
        &self,
        plan: &Plan,
        display: &Display,
        interrupt: &Interrupt,
    ) -> anyhow::Result<()> {
        let mut told: BTreeMap<usize, String> = BTreeMap::new();
        let mut open: Vec<usize> = (0..plan.tasks.len()).collect();
        let mut is_first = true;
        let mut is_deaf = false;
        loop {
            let live = self.queue();
            if let (Err(error), false) = (&live, is_deaf) {
                display.say(&format!("{error:#}; asking again"), true);
            }
            is_deaf = live.is_err();
            open.retain(|&index| {
                let Some(Record { seconds, .. }) = Record::of(&plan.tasks[index], &self.out) else {
                    return true;
                };
                let now = End::Finished { seconds };
                let end = if is_first { &End::Kept } else { &now };
                display.hear(&plan.tasks[index], Event::Ended(end));
                false
            });
            is_first = false;
            if let Ok(live) = live {
                if live.is_empty() {
                    return Ok(());
                }
                for (index, state) in live.iter().filter_map(|job| Some((job.task?, job.state()))) {
                    if open.contains(&index) && told.get(&index) != Some(&state) {
                        display.say(&format!("{}: {state}", plan.tasks[index].id), false);
                        told.insert(index, state);
                    }
                }
            }
            let asked = Instant::now();
            while asked.elapsed() < EVERY {
                if interrupt.wishes() > 0 {
                    return Err(anyhow::Error::new(DdlError::Interrupted).context(format!(
                        "no longer watching {}; its jobs go on, and the same command watches them again",
                        shell_word(&self.out)
                    )));
                }
                thread::sleep(BEAT);
            }
        }
    }
}

/// What a program of Slurm prints.
fn answer(command: &mut Command) -> anyhow::Result<String> {
    let name = command.get_program().display().to_string();
    let output = command.output().with_context(|| {
        format!("`{name}` cannot be started: `--executor slurm` needs Slurm's programs on the machine it is run on")
    })?;
    ensure!(
        output.status.success(),
        "`{}` failed ({}): {}",
        shown(&name, command.get_args()),
        output.status,
        String::from_utf8_lossy(&output.stderr).trim()
    );
    Ok(String::from_utf8_lossy(&output.stdout).into_owned())
}

fn shown<'a>(name: &str, arguments: impl Iterator<Item = &'a OsStr>) -> String {
    arguments.fold(name.to_owned(), |shown, argument| {
        shown + " " + &shell_word(Path::new(argument))
    })
}

#[cfg(all(test, unix))]
mod tests;
