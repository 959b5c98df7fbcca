//! The results of several runs as one report with its page and figures.

use crate::error::DdlError;
use crate::evaluation::record::measured_recordings;
use crate::run::directory::{RunDirectory, read_json, write_atomically, write_compact_json};
use ddl_report::page::Page;
use ddl_report::{ForecastSnapshot, Report};
use std::collections::BTreeMap;
use std::path::Path;

/// Results of evaluated runs and of other programs' forecasts, with windows for display.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Results {
    /// All rows.
    pub report: Report,
    /// Windows for display: of other programs' forecasts, and of the runs of the full variant with the lowest seed.
    pub moments: Vec<ForecastSnapshot>,
}

impl Results {
    /// Results that do not come from runs, such as those of another program's forecasts.
    #[must_use]
    pub fn new(report: Report, moments: Vec<ForecastSnapshot>) -> Self {
        Self { report, moments }
    }

    /// Gathers the results in folders that hold a `report.json`: evaluated runs, or results of other programs'
    /// forecasts.
    ///
    /// # Errors
    /// When a folder holds no results, one of its files is damaged, or two folders hold different numbers for the same
    /// conditions, or were evaluated on different recordings of the same name.
    pub fn of(title: impl Into<String>, folders: &[impl AsRef<Path>]) -> Result<Self, DdlError> {
        let mut results = Self { report: Report::new(title, [])?, moments: Vec::new() };
        let mut headline: Vec<(u64, Vec<ForecastSnapshot>)> = Vec::new();
        let mut elsewhere = Vec::new();
        let mut recordings = BTreeMap::new();
        for folder in folders {
            let run = RunDirectory::new(folder.as_ref());
            if !run.report().is_file() {
                return Err(DdlError::run(
                    run.path(),
                    "holds no results (report.json is missing); run `ddl evaluate` on it first",
                ));
            }
            let report = Report::load(&run.report())?;
            results.report.extend(report.rows().iter().cloned())?;
            // Results of another program's forecasts have no run.
            if !run.has_config() {
                elsewhere.extend(read_moments(&run)?);
                continue;
            }
            let config = run.config()?;
            for recording in measured_recordings(&run) {
                let name = (config.data.convention, recording.name);
                let (sha256, folder) =
                    recordings.entry(name.clone()).or_insert_with(|| (recording.sha256.clone(), run.path().to_owned()));
                if *sha256 != recording.sha256 {
                    // A mean over both would mean nothing.
                    let problem = format!(
                        "was evaluated on another recording {:?} than {}; evaluate both on the same recordings, or \
                         report them apart",
                        name.1,
                        folder.display()
                    );
                    return Err(DdlError::run(run.path(), problem));
                }
            }
            if config.star.name() == ddl_network::Variant::Full.name() {
                headline.push((config.training.seed, read_moments(&run)?));
            }
        }
        let lowest = headline.iter().map(|(seed, _)| *seed).min();
        let headline = headline.into_iter().filter(|(seed, _)| Some(*seed) == lowest);
        for moment in headline.flat_map(|(_, moments)| moments).chain(elsewhere) {
            // As rows, a moment that is given twice is kept once.
            if !results.moments.contains(&moment) {
                results.moments.push(moment);
            }
        }
        Ok(results)
    }

    /// Writes `report.md`, `report.json`, `moments.json`, the page `report.html` and its `figures/comparison.svg` into
    /// `folder`, which is created if missing. Existing files are replaced.
    ///
    /// # Errors
    /// When the folder or a file cannot be written, or a moment is wrong.
    pub fn save(&self, folder: &Path) -> Result<(), DdlError> {
        let figures = folder.join("figures");
        std::fs::create_dir_all(&figures).map_err(|error| DdlError::io(&figures, error))?;
        for (name, text) in self.report.files()? {
            write_atomically(&folder.join(name), text.as_bytes())?;
        }
        write_compact_json(&RunDirectory::new(folder).moments(), &self.moments)?;
        let page = Page { report: &self.report, moments: &self.moments };
        let file = figures.join("comparison.svg");
        match page.comparison()? {
            Some(svg) => write_atomically(&file, svg.as_bytes())?,
            // That of an earlier report could be mistaken for one of this report.
            None if file.exists() => std::fs::remove_file(&file).map_err(|error| DdlError::io(&file, error))?,
            None => {}
        }
        write_atomically(&folder.join("report.html"), page.to_html()?.as_bytes())
    }
}

/// The moments of a run; empty when there are none.
fn read_moments(run: &RunDirectory) -> Result<Vec<ForecastSnapshot>, DdlError> {
    let path = run.moments();
    if path.is_file() { read_json(&path) } else { Ok(Vec::new()) }
}
