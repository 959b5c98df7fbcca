//! The report of all finished runs.

use crate::command::Reporting;
use crate::command::benchmark::plan::BenchmarkPlan;
use crate::command::benchmark::profile::Profile;
use crate::output;
use crate::telling::tell;
use anyhow::Context as _;
use ddl::Results;
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// The main tables of the headline window rule, as docs/results.md shows them.
const SUMMARY: &str = "summary.md";

pub(super) fn write(plan: &BenchmarkPlan, runs: &[PathBuf], out: &Path, reporting: &Reporting) -> anyhow::Result<()> {
    let settings = &plan.settings;
    let profile = match settings.profile {
        Profile::Smoke => "smoke (a test of the program: the numbers mean nothing)".to_owned(),
        profile => profile.to_string(),
    };
    let title = format!("Benchmark: {}, {profile}, recipe {}", settings.convention, settings.recipe.name);
    if runs.is_empty() {
        return Ok(());
    }
    let results = Results::of(title, runs)?;
    results.save(out)?;
    let summary = results.report.summary(settings.convention);
    save_summary(summary.as_deref(), &out.join(SUMMARY))?;
    if reporting.telling.json {
        output::print(&(results.report.to_json()? + "\n"))?;
    } else {
        // The main tables: the whole report has more than a thousand lines.
        let text = summary.clone().unwrap_or_else(|| results.report.to_markdown());
        reporting.telling.print(&format!("\n{}\n\n", text.trim_end()))?;
    }
    let main_tables = summary.map(|_| ("main tables", SUMMARY));
    let others = [("report", "report.md"), ("", "report.json"), ("page", "report.html"), ("figures", "figures")];
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
