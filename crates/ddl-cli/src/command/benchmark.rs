mod child;
mod cost;
mod display;
#[cfg(test)]
mod fixture;
mod method;
mod plan;
mod profile;
mod publish;
mod readme;
mod report;
mod work;

pub(crate) use method::Method;
pub(crate) use plan::{Plan, Task};
pub(crate) use profile::Profile;

use super::recipe::Recipe;
use super::{Reporting, at_least_one, folder};
use crate::interrupt::Interrupt;
use crate::telling::{human, tell};
use anyhow::{Context as _, bail, ensure};
use clap::Args;
use ddl::data::{Convention, locate, remove_half_written};
use ddl::{DdlError, DeviceChoice, Protocol, RunLock};
use display::Display;
use plan::{Settings, Training};
use publish::Making;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::Instant;
use work::{End, Workers, side_by_side};

/// Train and measure a model of every fold, and write the report
///
/// Each model is a process of its own. Ctrl-C lets them save what they have; the same command goes on from there. `cargo xtask benchmark`
/// in a checkout brings in libtorch and the recordings, and builds this program, first.
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  \
        ddl benchmark\n  \
        ddl benchmark --convention simulated --profile smoke --out runs/smoke\n  \
        ddl benchmark --profile paper --seeds 0,1,2 --variants full,perceptron")]
pub(crate) struct Benchmark {
    /// How much work
    #[arg(long, value_enum, default_value_t = Profile::Quick)]
    profile: Profile,
    /// star, social-gan or simulated [default: the first of these whose recordings are there]
    #[arg(long)]
    convention: Option<Convention>,
    /// Folder of the recordings [default: `$DDL_DATASETS`, then `datasets/eth_ucy`]
    #[arg(long, value_name = "DIR")]
    data: Option<PathBuf>,
    /// Folds to test on, as in `eth,hotel` [default: the profile's]
    #[arg(long, value_delimiter = ',', value_name = "NAMES")]
    folds: Vec<String>,
    /// Variants to train: full, no-goal-shift, no-dynamics, star, perceptron (the full method with a network without attention), or
    /// all
    #[arg(
        long,
        value_delimiter = ',',
        value_name = "NAMES",
        default_value = "full"
    )]
    variants: Vec<String>,
    /// Protocols to score under: published, fair, single, online, online-single; with published every model is trained by the paper's recipe, without
    /// it by the recommended one, and the last epoch alone is kept
    #[arg(
        long = "protocol",
        value_delimiter = ',',
        value_name = "NAMES",
        default_value = "fair,single,online,online-single"
    )]
    protocols: Vec<Protocol>,
    /// Seeds; the report gives means and standard deviations over them
    #[arg(
        long,
        value_delimiter = ',',
        value_name = "NUMBERS",
        default_value = "1"
    )]
    seeds: Vec<u64>,
    /// Processes side by side, which share the cores [default: one a core; on cuda all tasks, at most five]
    #[arg(long, value_name = "N", value_parser = at_least_one)]
    jobs: Option<usize>,
    /// auto, cpu or cuda
    #[arg(long, default_value = "cpu")]
    device: DeviceChoice,
    /// Folder of the results; one that is there is gone on with [default: `runs/CONVENTION-PROFILE`,
    /// and `runs/CONVENTION-PROFILE-published` with the protocol published]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Walkers trained on in each epoch [default: the profile's, or else the recipe's]
    #[arg(long, value_name = "N")]
    train_walkers: Option<usize>,
    /// Test walkers scored [default: the profile's]
    #[arg(long, value_name = "N")]
    test_walkers: Option<usize>,
    /// Training epochs [default: the profile's]
    #[arg(long, value_name = "N")]
    epochs: Option<usize>,
    /// Also write the report, with what made it, to docs/benchmark.md of the checkout in this folder, and its tables into README.md;
    /// profiles but paper, conventions but star and the paper's recipe have pages of their own, named after them
    #[arg(long, value_name = "DIR")]
    publish: Option<PathBuf>,
    #[command(flatten)]
    reporting: Reporting,
}

impl Benchmark {
    pub(crate) fn run(&self) -> anyhow::Result<()> {
        if cfg!(not(feature = "torch")) {
            bail!(DdlError::WithoutLibtorch { what: "training" });
        }
        let start = Instant::now();
        let (convention, data) = self.recordings()?;
        let plan = self.plan(convention, data)?;
        let out = self.out_folder(&plan);
        fs::create_dir_all(&out).with_context(|| format!("cannot make {}", out.display()))?;
        let _claimed = RunLock::take(&out)?;
        // In the folders of tasks a process of an earlier benchmark may still be at work.
        remove_half_written(&out);
        plan.write(&out)?;
        let ends = self.work_off(&plan, &out)?;
        let finished: Vec<PathBuf> = plan
            .tasks
            .iter()
            .zip(&ends)
            .filter(|(_, end)| matches!(end, End::Finished { .. } | End::Kept))
            .map(|(task, _)| task.run_folder(&out))
            .collect();
        let (done, tasks) = (finished.len(), ends.len());
        if ends.contains(&End::Interrupted) {
            let took = human(start.elapsed());
            let stood = format!("{done} of {tasks} tasks are finished, after {took}");
            return Err(anyhow::Error::new(DdlError::Interrupted).context(stood));
        }
        let report = report::write(&plan, finished, &out, &self.reporting)?;
        tell(format_args!("wall time: {}", human(start.elapsed())));
        ensure!(
            done == tasks,
            "{} of {tasks} tasks failed (above); the same command tries them again",
            tasks - done
        );
        let Some(checkout) = &self.publish else {
            return Ok(());
        };
        ensure!(
            !ends.contains(&End::Kept),
            "--publish describes one whole run, but some tasks were kept from an earlier one: \
             delete {} or choose another --out",
            out.display()
        );
        let making = Making {
            commit: &self.reporting.commit,
            took: start.elapsed(),
            at: time::OffsetDateTime::now_utc(),
        };
        for file in publish::publish(checkout, &plan, &report, &making)? {
            tell(format_args!("published: {file}"));
        }
        Ok(())
    }

    fn recordings(&self) -> anyhow::Result<(Convention, Option<PathBuf>)> {
        let data = self.data.as_deref();
        let convention = match self.convention {
            Some(Convention::Own) => bail!(
                "a benchmark is of star, social-gan or simulated data; on your own recordings use `ddl train` and `ddl evaluate`"
            ),
            Some(convention) => convention,
            None => {
                let mut recorded = [Convention::Star, Convention::SocialGan].into_iter();
                let there = recorded.find(|&convention| locate(convention, data).is_ok());
                match (there, data) {
                    (Some(convention), _) => convention,
                    // It is said what the folder lacks.
                    (None, Some(_)) => Convention::Star,
                    (None, None) => Convention::Simulated,
                }
            }
        };
        let found = match convention {
            Convention::Simulated => None,
            recorded => Some(std::path::absolute(folder(recorded, data)?)?),
        };
        if self.convention.is_none() {
            tell(format_args!("data convention: {convention}"));
        }
        Ok((convention, found))
    }

    fn plan(&self, convention: Convention, data: Option<PathBuf>) -> anyhow::Result<Plan> {
        let mut protocols = self.protocols.clone();
        // How they were asked for makes no other results.
        protocols.sort_unstable();
        protocols.dedup();
        // The paper's for the paper's protocol, which compares with the paper.
        let name = if protocols.contains(&Protocol::Published) {
            Recipe::Published
        } else {
            Recipe::Recommended
        };
        if name == Recipe::Published && protocols.iter().any(|protocol| protocol.shows_past()) {
            bail!(
                "the protocol published measures the paper's recipe, whose models remember nothing of a place: measure online \
                 and online-single without it"
            );
        }
        let work = self.profile.work(name);
        let known: Vec<&str> = convention.fold_names().collect();
        let folds: Vec<String> = if self.folds.is_empty() {
            let first = known.iter().take(work.folds);
            first.map(|&fold| fold.to_owned()).collect()
        } else {
            for fold in &self.folds {
                one_of("fold", fold, &known)?;
            }
            self.folds.clone()
        };
        let methods = if self.variants == ["all"] {
            Method::ALL.to_vec()
        } else {
            let names = Method::ALL.map(Method::name);
            let methods = self.variants.iter();
            methods
                .map(|name| Ok(Method::ALL[one_of("variant", name, &names)?]))
                .collect::<anyhow::Result<_>>()?
        };
        let settings = Settings {
            profile: self.profile,
            convention,
            data,
            device: self.device,
            cargo_profile: if cfg!(debug_assertions) {
                "dev".to_owned()
            } else {
                "release".to_owned()
            },
            epochs: self.epochs.unwrap_or(work.epochs),
            train_walkers: self.train_walkers.or(work.train_walkers),
            proposal_steps: work.proposal_steps,
            test_walkers: self.test_walkers.or(work.test_walkers),
            protocols,
            recipe: Training {
                name,
                optimiser: work.optimiser,
            },
        };
        Plan::new(settings, &folds, &methods, &self.seeds)
    }

    fn out_folder(&self, plan: &Plan) -> PathBuf {
        let settings = &plan.settings;
        let suffix = publish::suffix(settings.recipe.name);
        let name = format!("{}-{}{suffix}", settings.convention, settings.profile);
        self.out
            .clone()
            .unwrap_or_else(|| Path::new("runs").join(name))
    }

    /// Runs the plan; Ctrl-C (or a termination signal) stops it cleanly, a second one at once.
    fn work_off(&self, plan: &Plan, out: &Path) -> anyhow::Result<Vec<End>> {
        // With the third this process ends too, whatever it is at.
        let interrupt = Interrupt::catch_until(3, |wishes| match wishes {
            1 => tell(format_args!(
                "\nstopping: running tasks save what they have (again: stop at once)"
            )),
            _ => tell(format_args!("\nstopping at once")),
        })?;
        let cores = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
        let (jobs, threads) = side_by_side(self.jobs, self.device, cores, plan.tasks.len());
        tell(format_args!(
            "plan: {} tasks, {jobs} at a time with {threads} threads each, in {}",
            plan.tasks.len(),
            out.display()
        ));
        let program =
            std::env::current_exe().context("this program does not know where it lies")?;
        let workers = Workers {
            program: vec![program.into()],
            jobs,
            threads,
            commit: self.reporting.commit.clone(),
        };
        let display = Display::new(plan, self.reporting.telling.progress);
        let watch = |task: &Task, event: work::Event<'_>| display.hear(task, event);
        let ends = workers.run(plan, out, &watch, &interrupt);
        display.close();
        Ok(ends)
    }
}

fn one_of(what: &str, name: &str, known: &[&str]) -> anyhow::Result<usize> {
    let index = known.iter().position(|known| *known == name);
    index.with_context(|| {
        format!(
            "there is no {what} {name:?}: choose from {}",
            known.join(", ")
        )
    })
}

#[cfg(test)]
mod tests;
