//! `ddl report`: results of several runs in one report.

use crate::command::Telling;
use crate::output;
use crate::paths::OutputPlace;
use clap::Args;
use ddl::Results;
use std::path::PathBuf;

/// Combine results into a page, tables and figures
///
/// Writes report.html, report.md, report.json, moments.json and figures.
#[derive(Debug, Args)]
#[command(mut_arg("progress", |arg| arg.help(crate::command::NO_PROGRESS)))]
#[command(after_help = "Example:\n  ddl report runs/eth runs/hotel --out runs")]
pub(crate) struct ReportCommand {
    /// Directories of evaluated runs
    #[arg(required = true)]
    runs: Vec<PathBuf>,
    /// First line of the report
    #[arg(long, default_value = "Results")]
    title: String,
    /// Folder to write to
    #[arg(long, value_hint = clap::ValueHint::AnyPath)]
    out: OutputPlace,
    #[command(flatten)]
    telling: Telling,
}

impl ReportCommand {
    pub(crate) fn run(self) -> anyhow::Result<()> {
        let results = Results::of(self.title, &self.runs)?;
        results.save(&self.out)?;
        output::print(&if self.telling.json {
            results.report.to_json()? + "\n"
        } else {
            format!("{}\n", self.out.join("report.html").display())
        })
    }
}
