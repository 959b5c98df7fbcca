//! `ddl evaluate --forecasts`: scores the forecasts of another program beside the baselines.

use crate::command::RecordingsAt;
use crate::command::test_windows::{TestWindows, ensure_scene_of_star};
use crate::paths::OutputPlace;
use anyhow::Context as _;
use clap::Args;
use ddl::data::Convention;
use ddl::eval::Conditions;
use ddl::eval::external::{self, Coverage, ExternalFormat};
use ddl::report::{Report, gallery};
use ddl::{BuiltinModel, Protocol, Results};
use std::path::{Path, PathBuf};

/// A file of forecasts, and the windows to score it on.
#[derive(Debug, Args)]
pub(crate) struct OtherProgram {
    /// Instead of a model: another program's forecasts of the lines of `ddl windows` (docs/your-model.md)
    ///
    /// The extension selects the format: csv, or JSON lines for others. A folder has sample files.
    #[arg(
        long,
        value_name = "FILE",
        // no network runs
        conflicts_with_all = ["device", "threads"],
        help_heading = "Forecasts of another program"
    )]
    pub(crate) forecasts: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) windows: TestWindows,
    /// Name of the other program in tables [default: the file's name]
    #[arg(long, requires = "forecasts")]
    name: Option<String>,
    /// Score only the pedestrians that are both in the windows and in the file, and note this in the results
    #[arg(long, requires = "forecasts")]
    intersection: bool,
    /// Folder for the report: report.html, report.md, report.json, moments.json and figures
    #[arg(long, value_name = "FOLDER", value_hint = clap::ValueHint::AnyPath)]
    pub(crate) out: Option<OutputPlace>,
}

impl OtherProgram {
    pub(crate) fn builtin_model(&self, recordings: &RecordingsAt) -> anyhow::Result<BuiltinModel> {
        self.windows.ensure_of_builtin_models()?;
        let fold = self.windows.fold.as_deref().unwrap_or_default();
        if recordings.is_named() {
            ensure_scene_of_star(fold)?;
        }
        Ok(fold.parse()?)
    }

    pub(crate) fn written(&self) -> String {
        match &self.out {
            Some(folder) => format!("all metrics: {}", folder.join("report.html").display()),
            None => "for all metrics as a page and as files, add --out FOLDER".to_owned(),
        }
    }

    pub(crate) fn evaluate(
        &self,
        file: &Path,
        protocols: &[Protocol],
        recordings: &RecordingsAt,
        commit: &str,
    ) -> anyhow::Result<Report> {
        if protocols.contains(&Protocol::Published) {
            return Err(external::ExternalError::Published.into());
        }
        let (fold, windows) = self.windows.windows(recordings)?;
        let convention = self.windows.convention(recordings, Convention::Star);
        let rule = self.windows.rule(convention);
        let coverage = if self.intersection { Coverage::Intersection } else { Coverage::Whole };
        let matched = if file.is_dir() {
            external::read_samples(file, &windows, coverage)
        } else {
            external::read(file, ExternalFormat::of_file(file), &windows, coverage)
        };
        let matched = matched.map_err(|error| match error {
            external::ExternalError::Missing { .. } | external::ExternalError::Unknown { .. } => anyhow::anyhow!(
                "{error} (windows of --convention {convention} --fold {fold}, rule {rule}; --intersection scores only \
                 the pedestrians in both)"
            ),
            error => error.into(),
        })?;
        let stem = file.file_stem().unwrap_or_default().to_string_lossy();
        let name = self.name.as_deref().unwrap_or(&stem);
        let mut rows = Vec::new();
        for &protocol in protocols {
            let conditions =
                Conditions { commit: commit.to_owned(), ..Conditions::new(convention, rule, protocol, &*fold, name) };
            rows.extend(external::measure(&conditions, &matched)?);
        }
        let report = Report::new(format!("{name} on {fold}"), rows)?;
        if let Some(folder) = &self.out {
            let moments = gallery::moments(&fold, name, &matched.windows, &matched.forecasts)?;
            Results::new(report.clone(), moments)
                .save(folder)
                .with_context(|| format!("cannot write to {}", folder.display()))?;
        }
        Ok(report)
    }
}
