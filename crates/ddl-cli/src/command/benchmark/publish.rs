//! Writes the main results of a benchmark, and how they were made, into the results page of the documentation.

use super::super::recipe::Recipe;
use super::choice::usual_folder;
use super::plan::Plan;
use super::record::Record;
use super::section;
use crate::telling::human;
use anyhow::{Context as _, ensure};
use ddl::data::{Convention, write_atomically};
use ddl::report::{Report, Summary};
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::time::Duration;
use time::OffsetDateTime;

pub(super) const PAGE: &str = "docs/results.md";

/// How the results were made, read from the finished tasks.
pub(super) struct Making {
    commits: Vec<String>,
    tasks: usize,
    took: Duration,
    processors: Vec<String>,
    at: OffsetDateTime,
}

impl Making {
    pub(super) fn of(plan: &Plan, report: &Report, out: &Path) -> Self {
        let tasks = plan.tasks.iter();
        let records: Vec<Record> = tasks.filter_map(|task| Record::of(task, out)).collect();
        let conditions = report.rows().iter().map(|row| &row.conditions);
        let trained = conditions.filter(|of| of.epochs.is_some());
        let processor = |record: &Record| {
            let name = record.processor.as_deref();
            name.unwrap_or("an unknown processor").to_owned()
        };
        Self {
            commits: unique(trained.map(|of| of.commit.clone())),
            tasks: records.len(),
            took: Duration::from_secs_f64(records.iter().map(|record| record.seconds).sum()),
            processors: unique(records.iter().map(processor)),
            at: OffsetDateTime::now_utc(),
        }
    }
}

fn unique<T: Ord>(values: impl Iterator<Item = T>) -> Vec<T> {
    let set: BTreeSet<T> = values.collect();
    set.into_iter().collect()
}

/// Fails if [`publish`] would fail after the benchmark.
pub(super) fn check(checkout: &Path, plan: &Plan) -> anyhow::Result<()> {
    ensure!(
        plan.settings.recipe.name == Recipe::Recommended,
        "--publish is for the recommended recipe: leave out --publish, or the protocol published"
    );
    with_section(checkout, plan.settings.convention, "").map(drop)
}

/// Writes the section of the plan's convention into the results page of the `checkout`.
pub(super) fn publish(checkout: &Path, plan: &Plan, report: &Report, making: &Making) -> anyhow::Result<()> {
    let convention = plan.settings.convention;
    let summary = report
        .summary(convention)
        .context("the report has no results that the page shows")?;
    let page = with_section(checkout, convention, &text(plan, &summary, making))?;
    write_atomically(&checkout.join(PAGE), page.as_bytes()).with_context(|| format!("cannot write {PAGE}"))
}

fn with_section(checkout: &Path, convention: Convention, text: &str) -> anyhow::Result<String> {
    let page = read(checkout, PAGE)?;
    section::replaced(&page, &format!(" in {convention}"), text)
        .with_context(|| format!("{PAGE} has no section for results in {convention}"))
}

fn read(checkout: &Path, file: &str) -> anyhow::Result<String> {
    let path = checkout.join(file);
    fs::read_to_string(&path).with_context(|| format!("cannot read {}", path.display()))
}

fn text(plan: &Plan, summary: &Summary, making: &Making) -> String {
    let settings = &plan.settings;
    let scored = settings.test_pedestrians.map_or_else(
        || "all test windows".to_owned(),
        |pedestrians| format!("{pedestrians} pedestrians of the test windows"),
    );
    let at = making.at;
    format!(
        "```sh\n{}\n```\n\n\
         Commit {}, seeds {}, recipe `{}`, {} epochs; published {} {:02}:{:02} UTC.\n\
         {} tasks took {} in sum on {}, device {}.\n\
         Window rule `{}`, {scored}.\n\
         Full tables: `report.md` and `report.html`, which the command writes into `{}`.\n\n\
         minADE/minFDE in metres:\n\n{:#}\n\
         Mean over the folds, with 95 % intervals:\n\n{:#}",
        command(plan),
        making.commits.join(", "),
        seeds(plan).join(", "),
        settings.recipe.name,
        settings.epochs,
        at.date(),
        at.hour(),
        at.minute(),
        making.tasks,
        human(making.took),
        making.processors.join(", "),
        settings.device,
        settings.convention.headline_rule(),
        usual_folder(plan).display(),
        summary.errors,
        summary.metrics,
    )
}

fn seeds(plan: &Plan) -> Vec<String> {
    let seeds = unique(plan.tasks.iter().map(|task| task.seed));
    seeds.iter().map(u64::to_string).collect()
}

/// Shell commands that repeat the benchmark on another machine; they name no folder of this machine.
fn command(plan: &Plan) -> String {
    let settings = &plan.settings;
    let folds = unique(plan.tasks.iter().map(|task| task.fold.as_str()));
    let methods = unique(plan.tasks.iter().map(|task| task.variant.name()));
    let protocols = settings.protocols.iter().map(ToString::to_string);
    let pedestrians = [
        ("train", settings.train_pedestrians),
        ("test", settings.test_pedestrians),
    ]
    .map(|(which, pedestrians)| {
        pedestrians.map_or(String::new(), |pedestrians| {
            format!(" --{which}-pedestrians {pedestrians}")
        })
    });
    format!(
        "cargo xtask benchmark --profile {} --convention {} --folds {} \\\n  --variants {} --protocol {} \\\n  \
         --seeds {} --epochs {} --device {} --cargo-profile {}{} --publish",
        settings.profile,
        settings.convention,
        folds.join(","),
        methods.join(","),
        protocols.collect::<Vec<_>>().join(","),
        seeds(plan).join(","),
        settings.epochs,
        settings.device,
        settings.cargo_profile,
        pedestrians.concat()
    )
}

#[cfg(test)]
#[path = "publish_tests.rs"]
mod tests;
