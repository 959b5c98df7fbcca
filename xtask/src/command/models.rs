//! `cargo xtask models`: the models that come with the program, out of a finished benchmark.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail, ensure};
use clap::Args;
use serde::Serialize;
use serde_json::Value;

use super::benchmark::build;
use super::set_up;
use crate::benchmark::{Plan, RecipeName, Task, fold_names};
use crate::data::Convention;
use crate::whole_file;
use crate::workspace::{Workspace, absolute};

/// Where the program's build looks for them.
const FOLDER: &str = "crates/ddl/models";
/// What the program calls a model that it has packed, in results.
const FORECASTER: &str = "DDL without an expert library";
/// Under which conditions a result is reported beside the weights: those of the headline.
const REPORTED: [(&str, &str); 3] = [
    ("convention", "star"),
    ("window_rule", "published"),
    ("protocol", "fair"),
];
/// What a repository can bear for each.
const MOST_BYTES: usize = 2_000_000;

#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Folder of a finished benchmark of the star recordings, with every fold
    #[arg(long, value_name = "DIR")]
    from: PathBuf,
    /// Seed of the runs to pack [default: the lowest of the benchmark]
    #[arg(long)]
    seed: Option<u64>,
    /// Program `ddl` that packs, built already [default: build it]
    #[arg(long, value_name = "FILE")]
    program: Option<PathBuf>,
    /// Folder to write to
    #[arg(long, value_name = "DIR", default_value = FOLDER)]
    out: PathBuf,
}

/// What a model reached on the scene that it was trained without.
#[derive(Debug, PartialEq, Serialize)]
struct Reported {
    convention: String,
    window_rule: String,
    protocol: String,
    min_ade: f64,
    min_fde: f64,
    /// Walkers scored.
    walkers: u64,
    /// `--test-walkers` of that evaluation; none is all.
    test_walkers: Option<u32>,
    seed: u64,
    /// Commit that measured it.
    commit: String,
}

impl Arguments {
    pub(crate) fn run(self, workspace: &Workspace) -> Result<()> {
        let from = absolute(&self.from)?;
        let plan = Plan::read(&from)?;
        let folds = fold_names(workspace, Convention::Star)?;
        let tasks = tasks(&plan, &folds, self.seed)?;
        let reported = tasks
            .iter()
            .map(|task| {
                let report = task.run_folder(&from).join("report.json");
                let result = reported(&report, task, plan.settings.test_walkers)
                    .with_context(|| format!("in {}", report.display()))?;
                Ok((task.fold.clone(), result))
            })
            .collect::<Result<BTreeMap<String, Reported>>>()?;
        let program = if let Some(program) = &self.program {
            absolute(program)?
        } else {
            set_up(workspace)?;
            build::program(workspace, "release")?
        };
        // Nothing is replaced before everything is there.
        let packed = tasks
            .iter()
            .map(|task| Ok((&task.fold, pack(&program, &task.run_folder(&from))?)))
            .collect::<Result<Vec<_>>>()?;
        let out = workspace.root().join(&self.out);
        for (fold, bytes) in packed {
            let file = out.join(format!("{fold}.safetensors"));
            whole_file::write(&file, &bytes)?;
            println!("{}: {} kB", file.display(), bytes.len() / 1000);
        }
        let mut text = serde_json::to_string_pretty(&reported)?;
        text.push('\n');
        let file = out.join("reported.json");
        whole_file::write(&file, text.as_bytes())?;
        println!("{}", file.display());
        Ok(())
    }
}

/// The run of each fold, of the whole method and of one seed.
fn tasks<'a>(plan: &'a Plan, folds: &[String], seed: Option<u64>) -> Result<Vec<&'a Task>> {
    let convention = &plan.settings.convention;
    ensure!(
        convention == Convention::Star.name(),
        "the models that come with the program are trained on star data, and that benchmark is of {convention} data"
    );
    let settings = &plan.settings;
    let recommended = settings.recipe.name == RecipeName::Recommended;
    ensure!(
        recommended && settings.profile == "paper" && settings.train_walkers.is_none(),
        "the models that come with the program are of the whole recommended recipe (--profile paper), and that benchmark is of profile \
         {}, recipe {}{}",
        settings.profile,
        settings.recipe.name,
        settings
            .train_walkers
            .map_or(String::new(), |walkers| format!(
                ", {walkers} walkers an epoch"
            )),
    );
    let full = || plan.tasks.iter().filter(|task| task.variant == "full");
    let seed = seed.or_else(|| full().map(|task| task.seed).min());
    folds
        .iter()
        .map(|fold| {
            full()
                .find(|task| task.fold == *fold && Some(task.seed) == seed)
                .with_context(|| {
                    format!("the benchmark has no run of the fold {fold}, variant full; run it with all folds")
                })
        })
        .collect()
}

/// The headline number of the run without its expert library.
fn reported(report: &Path, task: &Task, test_walkers: Option<u32>) -> Result<Reported> {
    let text = fs::read(report).context("cannot be read: is the benchmark finished?")?;
    let report: Value = serde_json::from_slice(&text).context("is damaged")?;
    let rows = report["rows"].as_array().context("has no rows")?;
    let row = rows.iter().find(|row| {
        let conditions = &row["conditions"];
        conditions["forecaster"] == FORECASTER
            && conditions["fold"] == *task.fold
            && conditions["seed"] == task.seed
            && REPORTED
                .iter()
                .all(|(name, value)| conditions[*name] == *value)
    });
    let Some(row) = row else {
        bail!(
            "has no row `{FORECASTER}` under {}; run the benchmark again, which measures anew what is older than this row",
            REPORTED.map(|(_, value)| value).join(", ")
        );
    };
    let score = |name: &str| {
        let value = row["scores"][name].as_f64();
        value.with_context(|| format!("has a row without the score {name}"))
    };
    let [convention, window_rule, protocol] = REPORTED.map(|(_, value)| value.to_owned());
    Ok(Reported {
        convention,
        window_rule,
        protocol,
        min_ade: score("min_ade")?,
        min_fde: score("min_fde")?,
        walkers: row["scores"]["pedestrians"]
            .as_u64()
            .context("has a row without walkers")?,
        test_walkers,
        seed: task.seed,
        commit: row["conditions"]["commit"]
            .as_str()
            .unwrap_or("unknown")
            .to_owned(),
    })
}

/// What the program makes of a run.
fn pack(program: &Path, run: &Path) -> Result<Vec<u8>> {
    let folder = tempfile::tempdir().context("there is no room for a temporary folder")?;
    let file = folder.path().join("model.safetensors");
    let status = Command::new(program)
        .arg("pack")
        .arg("--model")
        .arg(run)
        .arg("--out")
        .arg(&file)
        .stdout(std::process::Stdio::null())
        .status()
        .with_context(|| format!("{} cannot be started", program.display()))?;
    ensure!(
        status.success(),
        "{} cannot be packed (its message is above)",
        run.display()
    );
    let bytes = fs::read(&file).with_context(|| format!("{} was not written", file.display()))?;
    ensure!(
        bytes.len() <= MOST_BYTES,
        "{}, packed, is {} bytes long, and what comes with the program has at most {MOST_BYTES}; train a narrower network \
         (`--feed-forward-width`)",
        run.display(),
        bytes.len()
    );
    Ok(bytes)
}

#[cfg(test)]
mod tests;
