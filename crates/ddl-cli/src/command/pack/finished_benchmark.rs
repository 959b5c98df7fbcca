//! Packs the models of a finished benchmark together with their results, as the built-in models.

use crate::command::benchmark::{BenchmarkPlan, Method, Profile, Task};
use crate::command::pack::pack_model;
use crate::command::recipe::Recipe;
use anyhow::{Context as _, ensure};
use ddl::Protocol;
use ddl::data::{Convention, WindowRule, write_atomically};
use ddl::report::Report;
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

const FORECASTER: &str = "DDL as packed";
/// Largest size of a built-in model, bytes.
const MOST_BYTES: usize = 2_000_000;

#[derive(Debug, PartialEq, Serialize)]
struct Reported {
    convention: Convention,
    window_rule: WindowRule,
    protocol: Protocol,
    min_ade: f64,
    min_fde: f64,
    pedestrians: usize,
    /// `--test-pedestrians` of that evaluation; `None` for all.
    test_pedestrians: Option<usize>,
    seed: u64,
    commit: String,
}

pub(super) fn pack(benchmark: &Path, seed: Option<u64>, out: &Path) -> anyhow::Result<Vec<(PathBuf, usize)>> {
    let plan = BenchmarkPlan::read(benchmark)?;
    let tasks = tasks(&plan, seed)?;
    let mut reached = BTreeMap::new();
    for task in &tasks {
        let file = task.run_folder(benchmark).join("report.json");
        let result = Report::load(&file)
            .context("cannot read the results; finish the benchmark first")
            .and_then(|report| reported(&report, task, plan.settings.test_pedestrians))
            .with_context(|| format!("in {}", file.display()))?;
        reached.insert(task.fold.as_str(), result);
    }
    // Make all files before replacing any.
    let work = tempfile::tempdir().context("cannot create a temporary folder")?;
    let mut packed = Vec::new();
    for task in &tasks {
        let name = format!("{}.safetensors", task.fold);
        let run = task.run_folder(benchmark);
        let numbers = pack_model(&run, &work.path().join(&name))?;
        let bytes = std::fs::read(work.path().join(&name))?;
        ensure!(
            bytes.len() <= MOST_BYTES,
            "the packed model {} is {} bytes long, but a built-in model may have at most {MOST_BYTES}; train a \
             narrower network (`--feed-forward-width`)",
            run.display(),
            bytes.len()
        );
        packed.push((out.join(name), bytes, numbers));
    }
    std::fs::create_dir_all(out).with_context(|| format!("cannot create {}", out.display()))?;
    let write = |file: &Path, bytes: &[u8]| {
        write_atomically(file, bytes).with_context(|| format!("cannot write {}", file.display()))
    };
    for (file, bytes, _) in &packed {
        write(file, bytes)?;
    }
    let text = serde_json::to_string_pretty(&reached)? + "\n";
    write(&out.join("reported.json"), text.as_bytes())?;
    Ok(packed.into_iter().map(|(file, _, numbers)| (file, numbers)).collect())
}

fn tasks(plan: &BenchmarkPlan, seed: Option<u64>) -> anyhow::Result<Vec<&Task>> {
    let settings = &plan.settings;
    let whole = Profile::Paper.work(Recipe::Recommended).epochs;
    ensure!(
        settings.convention == Convention::Star,
        "the built-in models are trained on star data, but this benchmark is of {} data",
        settings.convention
    );
    ensure!(
        settings.recipe.name == Recipe::Recommended
            && settings.profile == Profile::Paper
            && settings.epochs == whole
            && settings.train_pedestrians.is_none(),
        "the built-in models are of the whole recommended recipe (--profile paper), but this benchmark is of profile \
         {}, recipe {}, {} epochs{}",
        settings.profile,
        settings.recipe.name,
        settings.epochs,
        settings
            .train_pedestrians
            .map_or(String::new(), |pedestrians| format!(", {pedestrians} pedestrians per epoch")),
    );
    let full = || plan.tasks.iter().filter(|task| task.variant == Method::FULL);
    let seed = seed.or_else(|| full().map(|task| task.seed).min());
    let folds = settings.convention.fold_names();
    folds
        .map(|fold| {
            full().find(|task| task.fold == fold && Some(task.seed) == seed).with_context(|| {
                let seed = seed.map_or(String::new(), |seed| format!(", seed {seed}"));
                format!("the benchmark has no run of fold {fold}, variant full{seed}; run it with all folds")
            })
        })
        .collect()
}

fn reported(report: &Report, task: &Task, test_pedestrians: Option<usize>) -> anyhow::Result<Reported> {
    let (convention, protocol) = (Convention::Star, Protocol::Fair);
    let window_rule = convention.headline_rule();
    let row = report.rows().iter().find(|row| {
        let conditions = &row.conditions;
        conditions.forecaster == FORECASTER
            && (conditions.convention, conditions.window_rule, conditions.protocol)
                == (convention, window_rule, protocol)
            && conditions.fold == task.fold
            && conditions.seed == Some(task.seed)
    });
    let row = row.with_context(|| {
        format!(
            "no row `{FORECASTER}` under {convention}, {window_rule}, {protocol}; run the benchmark again to add the \
             missing row"
        )
    })?;
    Ok(Reported {
        convention,
        window_rule,
        protocol,
        min_ade: row.scores.min_ade,
        min_fde: row.scores.min_fde,
        pedestrians: row.scores.pedestrians,
        test_pedestrians,
        seed: task.seed,
        commit: row.conditions.commit.clone(),
    })
}
