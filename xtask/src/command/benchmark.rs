//! `cargo xtask benchmark`: from nothing to the table.

pub(super) mod build;
mod publish;
mod readme;
mod report;
mod side_by_side;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::thread;
use std::time::Instant;

use anyhow::{Context, Result, bail, ensure};
use clap::Args;

use self::side_by_side::SideBySide;
use super::set_up;
use crate::benchmark::{
    Display, End, Executor, Local, Lock, PROTOCOLS, Plan, Profile, RecipeName, Settings, Stop,
    VARIANTS, fold_names, human,
};
use crate::data::{self, Chosen, Convention};
use crate::whole_file;
use crate::workspace::{Workspace, absolute};

/// Exit code of a run that was stopped and can be gone on with, as shells have it for Ctrl-C.
const INTERRUPTED: u8 = 130;

#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// How much work: smoke (a minute), quick (some minutes), evening or paper (all there is: about a quarter of an hour on two
    /// cores); with the protocol published smoke (a minute), quick (minutes), evening (60 epochs: an hour or two), paper (the
    /// paper's 200 epochs: some hours, or one GPU)
    #[arg(long, default_value = "quick")]
    profile: Profile,
    /// star, social-gan or simulated [default: the first of these that can be had]
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
    /// Protocols to score under: published, fair, single; with published every model is trained by the paper's recipe, without
    /// it by the recommended one, and the last epoch alone is kept
    #[arg(
        long,
        value_delimiter = ',',
        value_name = "NAMES",
        default_value = "fair,single"
    )]
    protocol: Vec<String>,
    /// Seeds; the report gives means and standard deviations over them
    #[arg(
        long,
        value_delimiter = ',',
        value_name = "NUMBERS",
        default_value = "1"
    )]
    seeds: Vec<u64>,
    /// Processes side by side, which share the cores [default: one a core; on cuda all tasks, at most five]
    #[arg(long, value_name = "N")]
    jobs: Option<usize>,
    /// auto, cpu or cuda
    #[arg(long, default_value = "cpu", value_parser = ["auto", "cpu", "cuda"])]
    device: String,
    /// Folder of the results; one that is there is gone on with [default: `runs/CONVENTION-PROFILE`,
    /// and `runs/CONVENTION-PROFILE-published` with the protocol published]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Program `ddl` to run, built already: needs no Rust and no checkout but its folder `datasets` [default: build it]
    #[arg(long, value_name = "FILE", conflicts_with_all = ["cargo_profile", "publish"])]
    program: Option<PathBuf>,
    /// Cargo profile the program is built with
    #[arg(long, default_value = "release", value_parser = ["release", "dev"])]
    cargo_profile: String,
    /// Walkers trained on in each epoch [default: the profile's, or else the recipe's]
    #[arg(long, value_name = "N")]
    train_walkers: Option<u32>,
    /// Test walkers scored [default: the profile's]
    #[arg(long, value_name = "N")]
    test_walkers: Option<u32>,
    /// Training epochs [default: the profile's]
    #[arg(long, value_name = "N")]
    epochs: Option<u32>,
    /// Also write the report to docs/benchmark.md, with what made it, and its tables into README.md; profiles but paper, conventions
    /// but star and the paper's recipe have pages of their own, named after them
    #[arg(long)]
    publish: bool,
}

impl Arguments {
    pub(crate) fn run(self, workspace: &Workspace) -> Result<ExitCode> {
        ensure!(self.jobs != Some(0), "--jobs must be at least 1");
        let start = Instant::now();
        let mut attempts = Vec::new();
        let chosen = data::choose(
            workspace,
            self.convention,
            self.data.as_deref(),
            &mut |text| {
                attempts.push(text.to_owned());
            },
        )?;
        println!("data convention: {} ({})", chosen.convention, chosen.reason);
        for attempt in attempts {
            eprintln!("{attempt}");
        }
        let plan = self.plan(workspace, &chosen)?;
        let out = self.out_folder(workspace, &plan)?;
        let _locked = Lock::take(&out)?;
        // In the folders of tasks a process of an earlier benchmark may still be at work.
        whole_file::remove_half_written(&out);
        plan.write(&out)?;
        let (program, commit) = self.program(workspace)?;
        let cores = thread::available_parallelism().map_or(1, std::num::NonZero::get);
        let SideBySide { jobs, threads } =
            SideBySide::new(self.jobs, &self.device, cores, plan.tasks.len());
        println!(
            "plan: {} tasks, {jobs} at a time with {threads} threads each, in {}",
            plan.tasks.len(),
            out.display()
        );
        let executor = Local::new(program.clone(), jobs, threads).of_commit(commit.clone());
        let ends = work_off(&executor, &plan, &out)?;
        let finished: Vec<PathBuf> = plan
            .tasks
            .iter()
            .zip(&ends)
            .filter(|(_, end)| matches!(end, End::Finished { .. } | End::Kept))
            .map(|(task, _)| task.run_folder(&out))
            .collect();
        if ends.contains(&End::Interrupted) {
            println!(
                "stopped after {}: {} of {} tasks are finished; the same command goes on from here",
                human(start.elapsed()),
                finished.len(),
                ends.len()
            );
            return Ok(ExitCode::from(INTERRUPTED));
        }
        let failed = ends.len() - finished.len();
        if !finished.is_empty() {
            report::write(workspace, &plan, &program, &finished, &out)?;
        }
        println!("wall time: {}", human(start.elapsed()));
        if failed > 0 {
            println!(
                "{failed} of {} tasks failed (above); a second run tries them again",
                ends.len()
            );
            return Ok(ExitCode::FAILURE);
        }
        if self.publish {
            ensure!(
                !ends.contains(&End::Kept),
                "--publish describes one whole run, but some tasks were kept from an earlier one: \
                 delete {} or choose another --out",
                out.display()
            );
            let folds = fold_names(workspace, chosen.convention)?;
            publish::publish(workspace, (&plan, &folds), (&out, &commit), start.elapsed())?;
        }
        Ok(ExitCode::SUCCESS)
    }

    /// Whether the program is given and not built here.
    pub(crate) fn has_program(&self) -> bool {
        self.program.is_some()
    }

    /// The program to run, and the commit that results name.
    fn program(&self, workspace: &Workspace) -> Result<(PathBuf, String)> {
        let Some(given) = &self.program else {
            set_up(workspace)?;
            let program = build::program(workspace, &self.cargo_profile)?;
            return Ok((program, workspace.commit()));
        };
        let program = absolute(given)?;
        ensure!(
            program.is_file(),
            "{} is no file: --program takes a built ddl",
            program.display()
        );
        // Which commit a given program is of, only who built it knows.
        let commit = std::env::var("DDL_COMMIT").unwrap_or_else(|_| "unknown".to_owned());
        Ok((program, commit))
    }

    fn plan(&self, workspace: &Workspace, chosen: &Chosen) -> Result<Plan> {
        let known = fold_names(workspace, chosen.convention)?;
        let folds = if self.folds.is_empty() {
            known.into_iter().take(self.profile.folds).collect()
        } else {
            check_names("fold", &self.folds, &known)?;
            self.folds.clone()
        };
        let all = VARIANTS.map(str::to_owned);
        let variants = if self.variants == ["all"] {
            all.to_vec()
        } else {
            check_names("variant", &self.variants, &all)?;
            self.variants.clone()
        };
        let protocols = protocols(&self.protocol)?;
        let training = self.profile.training(RecipeName::of_protocols(&protocols));
        let settings = Settings {
            profile: self.profile.name.to_owned(),
            convention: chosen.convention.name().to_owned(),
            data: chosen.folder.clone(),
            device: self.device.clone(),
            cargo_profile: match &self.program {
                Some(_) => "given program".to_owned(),
                None => self.cargo_profile.clone(),
            },
            epochs: self.epochs.unwrap_or(training.epochs),
            train_walkers: self.train_walkers.or(training.walkers),
            proposal_steps: self.profile.proposal_steps,
            test_walkers: self.test_walkers.or(self.profile.test_walkers),
            protocols,
            recipe: training.recipe.clone(),
        };
        Plan::new(settings, &folds, &variants, &self.seeds)
    }

    fn out_folder(&self, workspace: &Workspace, plan: &Plan) -> Result<PathBuf> {
        if let Some(folder) = &self.out {
            return absolute(folder);
        }
        let Settings {
            convention,
            profile,
            recipe,
            ..
        } = &plan.settings;
        let name = format!("{convention}-{profile}{}", recipe.name.suffix());
        Ok(workspace.path("runs").join(name))
    }
}

/// Runs the plan; Ctrl-C (or a termination signal) stops it cleanly, a second one at once.
fn work_off(executor: &dyn Executor, plan: &Plan, out: &Path) -> Result<Vec<End>> {
    let stop = Stop::default();
    let wish = stop.clone();
    ctrlc::set_handler(move || {
        wish.request();
        match wish.wishes() {
            1 => eprintln!("\nstopping: running tasks save what they have (again: stop at once)"),
            _ => eprintln!("\nstopping at once"),
        }
    })
    .context("Ctrl-C cannot be handled")?;
    let display = Display::new(plan);
    let ends = executor.run(plan, out, &display, &stop);
    display.close();
    ends
}

/// The protocols asked for, each once and in the usual order: how they were asked for makes no other results.
fn protocols(asked: &[String]) -> Result<Vec<String>> {
    let known = PROTOCOLS.map(str::to_owned);
    check_names("protocol", asked, &known)?;
    Ok(known
        .into_iter()
        .filter(|name| asked.contains(name))
        .collect())
}

fn check_names(what: &str, asked: &[String], known: &[String]) -> Result<()> {
    match asked.iter().find(|name| !known.contains(name)) {
        Some(name) => bail!(
            "there is no {what} {name:?}: choose from {}",
            known.join(", ")
        ),
        None => Ok(()),
    }
}

/// The benchmark as `ci` runs it: small, under every protocol, into a folder of its own, from the start, and
/// without a second build of everything.
pub(super) fn smoke(workspace: &Workspace) -> Result<()> {
    let out = workspace.path("target/ci-benchmark");
    if out.exists() {
        fs::remove_dir_all(&out).with_context(|| format!("{} cannot be deleted", out.display()))?;
    }
    let arguments = Arguments {
        profile: "smoke".parse()?,
        convention: None,
        data: None,
        folds: Vec::new(),
        variants: vec!["full".to_owned()],
        protocol: PROTOCOLS.map(str::to_owned).to_vec(),
        seeds: vec![1],
        jobs: None,
        device: "cpu".to_owned(),
        out: Some(out),
        program: None,
        cargo_profile: "dev".to_owned(),
        train_walkers: None,
        test_walkers: None,
        epochs: None,
        publish: false,
    };
    let code = arguments.run(workspace)?;
    ensure!(
        code == ExitCode::SUCCESS,
        "the smoke benchmark failed (above)"
    );
    Ok(())
}

#[cfg(test)]
mod tests;
