//! `ddl report`.

use anyhow::Context as _;
use clap::Args;
use ddl::eval::Report as Results;
use std::path::PathBuf;

/// Put the results of evaluated runs together into report.md and report.json
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
        let mut results = Results::new(self.title, [])?;
        for run in &self.runs {
            let path = ddl::RunDirectory::new(run).report();
            let report = Results::load(&path).with_context(|| {
                format!(
                    "{} holds no results; run `ddl evaluate` on it first",
                    run.display()
                )
            })?;
            results.extend(report.rows().iter().cloned())?;
        }
        std::fs::create_dir_all(&self.out)
            .with_context(|| format!("cannot make {}", self.out.display()))?;
        results.save(&self.out)?;
        Ok(())
    }
}
