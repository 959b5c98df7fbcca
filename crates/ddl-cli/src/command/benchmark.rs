//! `ddl benchmark`: trains and measures a model of every fold, here or on a cluster, and makes the report.

mod child;
mod choice;
mod display;
mod method;
mod pace;
mod plan;
mod profile;
mod record;
mod report;
mod work;

pub(crate) use method::Method;
pub(crate) use plan::{BenchmarkPlan, Task};
pub(crate) use profile::Profile;

use crate::command::{Reporting, at_least_one};
use crate::interrupt::Interrupt;
use crate::output::shell_word;
use crate::paths::OutputPlace;
use crate::telling::{human, tell};
use anyhow::{Context as _, bail, ensure};
use child::this_program;
use choice::PlanOptions;
use clap::{Args, ValueEnum};
use ddl::data::remove_temporary_files;
use ddl::{DdlError, RunLock};
use display::Display;
use record::Record;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::Instant;
use work::{TaskEnd, Workers, side_by_side};

/// Where the tasks run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Executor {
    /// This machine
    Local,
    /// Elsewhere, by --task and --collect: this command writes the plan only
    None,
}

/// Train and measure a model of every fold, and write the report
///
/// Each model is trained in a process of its own. After Ctrl-C the processes save their state, and the same command
/// resumes. In a checkout, `cargo xtask benchmark` first fetches libtorch and the recordings and builds this program.
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  ddl benchmark\n  ddl benchmark --convention simulated --profile smoke --out \
        runs/smoke\n  ddl benchmark --profile paper --seeds 0,1,2 --variants full,perceptron")]
pub(crate) struct Benchmark {
    #[command(flatten)]
    choice: PlanOptions,
    /// Where the tasks run
    #[arg(long, value_enum, default_value_t = Executor::Local)]
    executor: Executor,
    /// Run only task N of the plan in --out, counted from 0, as in `--task "$JOB_COMPLETION_INDEX"`
    #[arg(
        long,
        value_name = "N",
        requires = "out",
        conflicts_with_all = ["PlanOptions", "executor", "jobs", "collect"]
    )]
    task: Option<usize>,
    /// Only make the report of the plan in --out, from the tasks that are finished
    #[arg(long, requires = "out", conflicts_with_all = ["PlanOptions", "executor", "jobs"])]
    collect: bool,
    /// Processes that run at the same time and share the cores [default: one for each core; on cuda all tasks, at most
    /// five]
    #[arg(long, value_name = "N", value_parser = at_least_one)]
    jobs: Option<usize>,
    /// Cores to use [default: those that Slurm grants, or else all]
    #[arg(long, value_name = "N", value_parser = at_least_one, env = "SLURM_CPUS_PER_TASK")]
    threads: Option<usize>,
    /// Folder of the results; a benchmark in it is resumed [default: `runs/CONVENTION-PROFILE`, and
    /// `runs/CONVENTION-PROFILE-published` with the protocol published]
    #[arg(long, value_name = "DIR", value_hint = clap::ValueHint::AnyPath)]
    out: Option<OutputPlace>,
    #[command(flatten)]
    reporting: Reporting,
}

impl Benchmark {
    pub(crate) fn run(&self) -> anyhow::Result<()> {
        if let (true, Some(out)) = (self.collect, &self.out) {
            return self.collect(out);
        }
        if cfg!(not(feature = "torch")) {
            bail!(DdlError::WithoutLibtorch { what: "training" });
        }
        if let (Some(index), Some(out)) = (self.task, &self.out) {
            return self.do_task(index, out);
        }
        let plan = self.choice.plan()?;
        let out = self.out.clone().map_or_else(|| choice::usual_folder(&plan), PathBuf::from);
        fs::create_dir_all(&out).with_context(|| format!("cannot make {}", out.display()))?;
        let _claimed = RunLock::take(&out)?;
        // The folders of tasks are left alone, because a process of an earlier benchmark may still write there.
        remove_temporary_files(&out);
        match self.executor {
            Executor::Local => self.run_here(&plan, &out),
            Executor::None => {
                plan.write(&out)?;
                let command = format!("ddl benchmark --out {}", shell_word(&out));
                tell(format_args!(
                    "plan: {} tasks; `{command} --task N` runs one (N from 0 to {}), then `{command} --collect` makes \
                     the report",
                    plan.tasks.len(),
                    plan.tasks.len() - 1
                ));
                Ok(())
            }
        }
    }

    fn run_here(&self, plan: &BenchmarkPlan, out: &Path) -> anyhow::Result<()> {
        let start = Instant::now();
        plan.write(out)?;
        let ends = self.work_off(plan, out)?;
        if ends.contains(&TaskEnd::Interrupted) {
            let took = human(start.elapsed());
            let finished = plan.tasks.iter().filter(|t| Record::of(t, out).is_some());
            let (finished, all) = (finished.count(), ends.len());
            let progress = format!("{finished} of {all} tasks are finished, after {took}");
            return Err(anyhow::Error::new(DdlError::Interrupted).context(progress));
        }
        self.report(plan, out)?;
        tell(format_args!("wall time: {}", human(start.elapsed())));
        Ok(())
    }

    fn do_task(&self, index: usize, out: &Path) -> anyhow::Result<()> {
        let plan = BenchmarkPlan::read(out)?;
        let task = plan.tasks.get(index).with_context(|| {
            let (out, all) = (out.display(), plan.tasks.len());
            format!("no task {index}: the plan of {out} has {all} tasks, counted from 0")
        })?;
        let interrupt = catch()?;
        let workers = self.workers(1, self.cores())?;
        let display = Display::new(std::slice::from_ref(task), self.reporting.telling.progress);
        let watch = |task: &Task, event: work::Event<'_>| display.note_event(task, event);
        let end = workers.run_task(&plan, task, out, &watch, &interrupt);
        watch(task, work::Event::Ended(&end));
        match end {
            TaskEnd::Finished { .. } | TaskEnd::Kept => Ok(()),
            TaskEnd::Failed { .. } => bail!("{} failed (above)", task.id),
            TaskEnd::Interrupted => Err(DdlError::Interrupted.into()),
        }
    }

    fn collect(&self, out: &Path) -> anyhow::Result<()> {
        let _claimed = RunLock::take(out)?;
        remove_temporary_files(out);
        self.report(&BenchmarkPlan::read(out)?, out)
    }

    /// Makes the report of the finished tasks.
    ///
    /// # Errors
    /// When the report cannot be written, or tasks are not finished; then the report of the finished ones is written
    /// before.
    fn report(&self, plan: &BenchmarkPlan, out: &Path) -> anyhow::Result<()> {
        let (finished, missing): (Vec<&Task>, Vec<&Task>) =
            plan.tasks.iter().partition(|task| Record::of(task, out).is_some());
        let runs: Vec<PathBuf> = finished.iter().map(|task| task.run_folder(out)).collect();
        report::write(plan, &runs, out, &self.reporting)?;
        let names: Vec<&str> = missing.iter().map(|task| task.id.as_str()).collect();
        ensure!(
            names.is_empty(),
            "{} of {} tasks are not finished: {}; log.txt in the folder of each says why; the same command runs them \
             again",
            names.len(),
            plan.tasks.len(),
            names.join(", ")
        );
        Ok(())
    }

    fn work_off(&self, plan: &BenchmarkPlan, out: &Path) -> anyhow::Result<Vec<TaskEnd>> {
        let interrupt = catch()?;
        let tasks = plan.tasks.len();
        let (jobs, threads) = side_by_side(self.jobs, plan.settings.device, self.cores(), tasks);
        tell(format_args!("plan: {tasks} tasks, {jobs} at a time with {threads} threads each, in {}", out.display()));
        let display = Display::new(&plan.tasks, self.reporting.telling.progress);
        let watch = |task: &Task, event: work::Event<'_>| display.note_event(task, event);
        Ok(self.workers(jobs, threads)?.run(plan, out, &watch, &interrupt))
    }

    fn workers(&self, jobs: usize, threads: usize) -> anyhow::Result<Workers> {
        Ok(Workers { program: vec![this_program()?.into()], jobs, threads, commit: self.reporting.commit.clone() })
    }

    fn cores(&self) -> usize {
        self.threads.unwrap_or_else(|| std::thread::available_parallelism().map_or(1, std::num::NonZero::get))
    }
}

/// The first Ctrl-C (or termination signal) stops the tasks cleanly, a second one at once; the third ends this process
/// at any point.
fn catch() -> anyhow::Result<Interrupt> {
    Interrupt::catch_until(3, |wishes| match wishes {
        1 => tell(format_args!("\nstopping: running tasks save their state (Ctrl-C again: stop at once)")),
        _ => tell(format_args!("\nstopping at once")),
    })
}
