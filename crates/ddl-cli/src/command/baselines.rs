//! `ddl baselines`: scores of the baselines alone.

use crate::command::test_windows::NO_WINDOW;
use crate::command::{RecordingsAt, Reporting, at_least_one};
use anyhow::ensure;
use clap::Args;
use ddl::data::Convention;
use ddl::report::Report;
use ddl::{BaselineRequest, Protocol, Results};
use std::path::PathBuf;

/// Evaluate constant velocity and other baselines on test scenes
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  ddl baselines --convention social-gan --out runs/baselines-social-gan")]
pub(crate) struct Baselines {
    /// star, social-gan, simulated or own
    #[arg(long)]
    convention: Convention,
    #[command(flatten)]
    recordings: RecordingsAt,
    /// Fold to evaluate on; may be repeated [default: all]
    #[arg(long = "fold")]
    folds: Vec<String>,
    /// Protocol: published, fair or single; may be repeated
    #[arg(long = "protocol", value_delimiter = ',', default_values = ["fair", "single"])]
    protocols: Vec<Protocol>,
    /// Evaluate a seeded part of the test windows, about this many pedestrians per fold under the widest window rule
    /// [default: all]
    #[arg(long, value_parser = at_least_one)]
    test_pedestrians: Option<usize>,
    /// Folder for the report: report.html, report.md, report.json and figures [default: only print]
    #[arg(long)]
    out: Option<PathBuf>,
    #[command(flatten)]
    reporting: Reporting,
}

impl Baselines {
    pub(crate) fn run(self) -> anyhow::Result<()> {
        let dataset = self.recordings.dataset(self.convention)?;
        let folds = if self.folds.is_empty() {
            let names = dataset.fold_names().into_iter();
            names.map(str::to_owned).collect()
        } else {
            self.folds
        };
        let request = BaselineRequest {
            folds,
            protocols: self.protocols,
            test_pedestrians: self.test_pedestrians,
            commit: self.reporting.commit.clone(),
        };
        let title = format!("Baselines: {}", self.convention);
        let report = Report::new(title, ddl::measure_baselines(&dataset, &request)?)?;
        ensure!(!report.rows().is_empty(), NO_WINDOW);
        let rest = match &self.out {
            Some(folder) => {
                Results::new(report.clone(), Vec::new()).save(folder)?;
                format!("all metrics: {}", folder.join("report.html").display())
            }
            None => "for all metrics as a page and as files, add --out FOLDER".to_owned(),
        };
        self.reporting.print(&report, &rest)
    }
}
