mod child;
mod choice;
mod cost;
mod display;
#[cfg(test)]
mod fixture;
mod method;
mod plan;
mod processor;
mod profile;
mod publish;
mod record;
mod report;
mod section;
mod slurm;
mod work;

pub(crate) use method::Method;
pub(crate) use plan::{Plan, Task};
pub(crate) use profile::Profile;

use super::{Reporting, at_least_one};
use crate::interrupt::Interrupt;
use crate::output::shell_word;
use crate::telling::{human, tell};
use anyhow::{Context as _, bail, ensure};
use choice::Choice;
use clap::{Args, ValueEnum};
use ddl::data::remove_temporary_files;
use ddl::report::Report;
use ddl::{DdlError, RunLock};
use display::Display;
use publish::Making;
use record::Record;
use slurm::Slurm;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::Instant;
use work::{End, Workers, side_by_side};

/// Where the tasks run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Executor {
    /// This machine
    Local,
    /// Slurm: an array of jobs, and one job that makes the report; this program watches them
    Slurm,
    /// Elsewhere, by --task and --collect: this command writes the plan only
    None,
}

/// Train and measure a model of every fold, and write the report
///
/// Each model is trained in a process of its own. After Ctrl-C the processes save their state, and the same command
/// resumes. In a checkout, `cargo xtask benchmark` first fetches libtorch and the recordings and builds this program.
#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  ddl benchmark\n  ddl benchmark --convention simulated --profile smoke --out \
        runs/smoke\n  ddl benchmark --profile paper --seeds 0,1,2 --variants full,perceptron\n  \
        SBATCH_TIMELIMIT=2:00:00 ddl benchmark --executor slurm --threads 4"
)]
pub(crate) struct Benchmark {
    #[command(flatten)]
    choice: Choice,
    /// Where the tasks run; with slurm the variables of `sbatch` (`SBATCH_PARTITION`, `SBATCH_ACCOUNT`,
    /// `SBATCH_TIMELIMIT`, ...) apply
    #[arg(long, value_enum, default_value_t = Executor::Local)]
    executor: Executor,
    /// Run only task N of the plan in --out, counted from 0, as in `--task "$JOB_COMPLETION_INDEX"`
    #[arg(
        long,
        value_name = "N",
        requires = "out",
        conflicts_with_all = ["Choice", "executor", "jobs", "publish", "collect"]
    )]
    task: Option<usize>,
    /// Only make the report of the plan in --out, from the tasks that are finished
    #[arg(long, requires = "out", conflicts_with_all = ["Choice", "executor", "jobs"])]
    collect: bool,
    /// Processes that run at the same time and share the cores [default: one for each core; on cuda all tasks, at most
    /// five; with slurm all tasks]
    #[arg(long, value_name = "N", value_parser = at_least_one)]
    jobs: Option<usize>,
    /// Cores to use; with slurm for each task [default: those that Slurm grants, or else all; with slurm 1]
    #[arg(long, value_name = "N", value_parser = at_least_one, env = "SLURM_CPUS_PER_TASK")]
    threads: Option<usize>,
    /// Folder of the results; a benchmark in it is resumed [default: `runs/CONVENTION-PROFILE`, and
    /// `runs/CONVENTION-PROFILE-published` with the protocol published]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Also write the main results into the section of the convention in docs/results.md of the checkout in this folder
    #[arg(long, value_name = "DIR")]
    publish: Option<PathBuf>,
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
        ensure!(
            self.publish.is_none() || self.executor != Executor::None,
            "--publish needs results: with `--executor none`, publish when the tasks are finished, by `--collect \
             --publish DIR`"
        );
        let plan = self.choice.plan()?;
        if let Some(checkout) = &self.publish {
            publish::check(checkout, &plan)?;
        }
        let out = self.out.clone().unwrap_or_else(|| choice::usual_folder(&plan));
        fs::create_dir_all(&out).with_context(|| format!("cannot make {}", out.display()))?;
        let claimed = RunLock::take(&out)?;
        // The folders of tasks are left alone, because a process of an earlier benchmark may still write there.
        remove_temporary_files(&out);
        match self.executor {
            Executor::Local => self.run_here(&plan, &out),
            Executor::Slurm => self.run_on_slurm(&plan, &out, claimed),
            Executor::None => {
                plan.write(&out)?;
                let of = format!("ddl benchmark --out {}", shell_word(&out));
                tell(format_args!(
                    "plan: {} tasks; `{of} --task N` runs one (N from 0 to {}), then `{of} --collect` makes the report",
                    plan.tasks.len(),
                    plan.tasks.len() - 1
                ));
                Ok(())
            }
        }
    }

    fn run_here(&self, plan: &Plan, out: &Path) -> anyhow::Result<()> {
        let start = Instant::now();
        plan.write(out)?;
        let ends = self.work_off(plan, out)?;
        if ends.contains(&End::Interrupted) {
            let took = human(start.elapsed());
            let finished = plan.tasks.iter().filter(|t| Record::of(t, out).is_some());
            let progress = format!(
                "{} of {} tasks are finished, after {took}",
                finished.count(),
                ends.len()
            );
            return Err(anyhow::Error::new(DdlError::Interrupted).context(progress));
        }
        let report = self.report(plan, out)?;
        tell(format_args!("wall time: {}", human(start.elapsed())));
        self.publish(plan, &report, out)
    }

    fn publish(&self, plan: &Plan, report: &Report, out: &Path) -> anyhow::Result<()> {
        let Some(checkout) = &self.publish else {
            return Ok(());
        };
        let making = Making::of(plan, report, out);
        publish::publish(checkout, plan, report, &making)?;
        tell(format_args!("published: {}", publish::PAGE));
        Ok(())
    }

    /// Submits the unfinished tasks, unless jobs of the folder are in the queue, and watches until all jobs have ended.
    fn run_on_slurm(&self, plan: &Plan, out: &Path, claimed: RunLock) -> anyhow::Result<()> {
        let slurm = Slurm::new(out, &self.reporting.commit)?;
        let live = slurm.queue()?;
        if live.is_empty() {
            plan.write(out)?;
            slurm.submit(plan, self.jobs, self.threads.unwrap_or(1))?;
        } else {
            let ids = slurm::ids(&live);
            ensure!(
                Plan::read(out)? == *plan,
                "jobs of another plan run in {}: wait for their end, cancel them with `scancel {ids}`, or choose \
                 another --out",
                out.display()
            );
            tell(format_args!(
                "jobs {ids} of this folder are in the queue: this command watches them and submits nothing"
            ));
        }
        // The job that makes the report takes the lock.
        drop(claimed);
        let interrupt = Interrupt::catch()?;
        let display = Display::new(&plan.tasks, self.reporting.telling.progress);
        let watched = slurm.watch(plan, &display, &interrupt);
        display.close();
        watched?;
        self.collect(out)
    }

    fn do_task(&self, index: usize, out: &Path) -> anyhow::Result<()> {
        let plan = Plan::read(out)?;
        let task = plan.tasks.get(index).with_context(|| {
            format!(
                "no task {index}: the plan of {} has {} tasks, counted from 0",
                out.display(),
                plan.tasks.len()
            )
        })?;
        let interrupt = catch()?;
        let workers = self.workers(1, self.cores())?;
        let display = Display::new(std::slice::from_ref(task), self.reporting.telling.progress);
        let watch = |task: &Task, event: work::Event<'_>| display.hear(task, event);
        let end = workers.run_task(&plan, task, out, &watch, &interrupt);
        watch(task, work::Event::Ended(&end));
        display.close();
        match end {
            End::Finished { .. } | End::Kept => Ok(()),
            End::Failed { .. } => bail!("{} failed (above)", task.id),
            End::Interrupted => Err(DdlError::Interrupted.into()),
        }
    }

    fn collect(&self, out: &Path) -> anyhow::Result<()> {
        let _claimed = RunLock::take(out)?;
        remove_temporary_files(out);
        let plan = Plan::read(out)?;
        if let Some(checkout) = &self.publish {
            publish::check(checkout, &plan)?;
        }
        let report = self.report(&plan, out)?;
        self.publish(&plan, &report, out)
    }

    /// Makes the report of the finished tasks.
    ///
    /// # Errors
    /// When the report cannot be written, or tasks are not finished; then the report of the finished ones is written
    /// before.
    fn report(&self, plan: &Plan, out: &Path) -> anyhow::Result<Report> {
        let (finished, missing): (Vec<&Task>, Vec<&Task>) =
            plan.tasks.iter().partition(|task| Record::of(task, out).is_some());
        let runs = finished.iter().map(|task| task.run_folder(out)).collect();
        let report = report::write(plan, runs, out, &self.reporting)?;
        let names: Vec<&str> = missing.iter().map(|task| task.id.as_str()).collect();
        ensure!(
            names.is_empty(),
            "{} of {} tasks are not finished: {}; log.txt in the folder of each says why; the same command runs them \
             again",
            names.len(),
            plan.tasks.len(),
            names.join(", ")
        );
        Ok(report)
    }

    fn work_off(&self, plan: &Plan, out: &Path) -> anyhow::Result<Vec<End>> {
        let interrupt = catch()?;
        let tasks = plan.tasks.len();
        let (jobs, threads) = side_by_side(self.jobs, plan.settings.device, self.cores(), tasks);
        tell(format_args!(
            "plan: {tasks} tasks, {jobs} at a time with {threads} threads each, in {}",
            out.display()
        ));
        let display = Display::new(&plan.tasks, self.reporting.telling.progress);
        let watch = |task: &Task, event: work::Event<'_>| display.hear(task, event);
        let workers = self.workers(jobs, threads)?;
        let ends = workers.run(plan, out, &watch, &interrupt);
        display.close();
        Ok(ends)
    }

    fn workers(&self, jobs: usize, threads: usize) -> anyhow::Result<Workers> {
        Ok(Workers {
            program: vec![this_program()?.into()],
            jobs,
            threads,
            commit: self.reporting.commit.clone(),
        })
    }

    fn cores(&self) -> usize {
        let all = || std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
        self.threads.unwrap_or_else(all)
    }
}

/// The first Ctrl-C (or termination signal) stops the tasks cleanly, a second one at once; the third ends this process
/// at any point.
fn catch() -> anyhow::Result<Interrupt> {
    Interrupt::catch_until(3, |wishes| match wishes {
        1 => tell(format_args!(
            "\nstopping: running tasks save their state (Ctrl-C again: stop at once)"
        )),
        _ => tell(format_args!("\nstopping at once")),
    })
}

fn this_program() -> anyhow::Result<PathBuf> {
    std::env::current_exe().context("cannot find the path of this program")
}
