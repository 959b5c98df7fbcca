//! `ddl report`.

use clap::Args;
use ddl::Results;
use std::path::PathBuf;

/// Put the results of evaluated runs together: report.html to look at, report.md, report.tex, report.json, moments.json and
/// figures
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  ddl report runs/eth runs/hotel --out runs")]
pub(crate) struct Report {
    /// Directories of evaluated runs
    #[arg(required = true)]
    runs: Vec<PathBuf>,
    /// First line of the report
    #[arg(long, default_value = "Results")]
    title: String,
    /// Folder to write to
    #[arg(long)]
    out: PathBuf,
}

impl Report {
    pub(crate) fn run(self) -> anyhow::Result<()> {
        Ok(Results::of(self.title, &self.runs)?.save(&self.out)?)
    }
}
