//! The report of all finished runs, with the baselines in the other data convention.

use crate::command::benchmark::plan::{Plan, Settings};
use crate::command::benchmark::profile::Profile;
use crate::command::{Reporting, baselines};
use crate::output;
use crate::progress::ProgressMode;
use crate::telling::tell;
use anyhow::Context as _;
use ddl::data::{Convention, Dataset, locate};
use ddl::{BaselineRequest, Protocol, Results};
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// The main tables of the headline window rule, as docs/results.md shows them.
const SUMMARY: &str = "summary.md";

pub(super) fn write(plan: &Plan, runs: Vec<PathBuf>, out: &Path, reporting: &Reporting) -> anyhow::Result<()> {
    let settings = &plan.settings;
    let profile = match settings.profile {
        Profile::Smoke => "smoke (a test of the program: the numbers mean nothing)".to_owned(),
        profile => profile.to_string(),
    };
    let title = format!(
        "Benchmark: {}, {profile}, recipe {}",
        settings.convention, settings.recipe.name
    );
    if runs.is_empty() {
        return Ok(());
    }
    let mut folders = runs;
    folders.extend(baselines_elsewhere(settings, out, &reporting.commit)?);
    let results = Results::of(title, &folders)?;
    results.save(out)?;
    let summary = results.report.summary(settings.convention);
    save_summary(summary.as_deref(), &out.join(SUMMARY))?;
    if reporting.telling.json {
        output::print(&(results.report.to_json()? + "\n"))?;
    } else if reporting.telling.progress != ProgressMode::Json {
        // The main tables: the whole report has more than a thousand lines.
        let text = summary.clone().unwrap_or_else(|| results.report.to_markdown());
        output::print(&format!("\n{}\n\n", text.trim_end()))?;
    }
    let main_tables = summary.map(|_| ("main tables", SUMMARY));
    let others = [
        ("report", "report.md"),
        ("", "report.json"),
        ("for a paper", "report.tex"),
        ("page", "report.html"),
        ("figures", "figures"),
    ];
    for (what, name) in main_tables.into_iter().chain(others) {
        tell(format_args!("{what:12} {}", out.join(name).display()));
    }
    Ok(())
}

/// Writes the main tables; without any, as with the protocol `published` alone, removes those of an earlier report.
fn save_summary(summary: Option<&str>, file: &Path) -> anyhow::Result<()> {
    if let Some(summary) = summary {
        return output::write_output(Some(file), summary);
    }
    match fs::remove_file(file) {
        Err(error) if error.kind() != ErrorKind::NotFound => {
            Err(error).with_context(|| format!("cannot remove {}, which is out of date", file.display()))
        }
        _ => Ok(()),
    }
}

/// The baselines in the other recorded convention, if its recordings are there. These rows need no training, and show
/// how far the two conventions differ.
fn baselines_elsewhere(settings: &Settings, out: &Path, commit: &str) -> anyhow::Result<Option<PathBuf>> {
    let other = match settings.convention {
        Convention::Star => Convention::SocialGan,
        Convention::SocialGan => Convention::Star,
        Convention::Simulated | Convention::Own => return Ok(None),
    };
    // `published` chooses with the true future, which is not meaningful for baselines.
    let mut protocols = settings.protocols.clone();
    protocols.retain(|protocol| *protocol != Protocol::Published);
    let beside = settings.data.as_deref();
    let Ok(folder) = locate(other, None).or_else(|_| locate(other, beside)) else {
        return Ok(None);
    };
    if protocols.is_empty() {
        return Ok(None);
    }
    let dataset = Dataset::load(other, &folder)?;
    let request = BaselineRequest {
        folds: other.fold_names().map(str::to_owned).collect(),
        protocols,
        test_pedestrians: settings.test_pedestrians,
        commit: commit.to_owned(),
    };
    let report = baselines::measure(&dataset, &request)?;
    let folder = out.join(format!("baselines-{other}"));
    Results::new(report, Vec::new()).save(&folder)?;
    Ok(Some(folder))
}
