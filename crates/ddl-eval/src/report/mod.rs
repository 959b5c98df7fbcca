//! Results of several runs put together: tables for people, JSON for programs.

use std::{io::Write, path::Path};

use serde::{Deserialize, Serialize};

use crate::{ResultRow, document::Document, error::ReportError};

mod ablation;
mod across_protocols;
mod categories;
mod content;
mod further;
mod group;
mod published;
mod recordings;
mod section;
mod significance;
mod spread;
mod whole_forecast;

pub(crate) use group::{Group, Line, groups};

/// Version of the JSON file.
const FORMAT: u32 = 1;

/// Results of any number of runs.
///
/// Rows are grouped into one table for each data convention, window rule, protocol and test subset,
/// so that no column mixes numbers that cannot be compared.
///
/// # Examples
/// ```
/// use ddl_data::{Convention, WindowRule};
/// use ddl_eval::{Conditions, Protocol, Report, baseline};
/// # use ddl_data::{PedestrianId, Window};
/// # let walk = (0..20).map(|t| [0.4 * f64::from(t), 0.0]).collect();
/// # let test_windows = vec![Window::new("eth", 0, 6, vec![PedestrianId(1)], vec![walk])?];
/// let conditions =
///     Conditions::new(Convention::Star, WindowRule::Published, Protocol::Single, "eth", "");
/// let rows = baseline::measure(&conditions, &test_windows, 1)?;
/// let report = Report::new("Baselines on eth", rows)?;
/// assert!(report.to_markdown().starts_with("Data convention: `star`"));
/// assert_eq!(Report::from_json(&report.to_json()?)?, report);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Report {
    format: u32,
    title: String,
    rows: Vec<ResultRow>,
}

impl Report {
    /// A report of these rows. A row given twice is kept once.
    ///
    /// # Errors
    /// Two rows name the same conditions and hold different scores.
    pub fn new(
        title: impl Into<String>,
        rows: impl IntoIterator<Item = ResultRow>,
    ) -> Result<Self, ReportError> {
        let mut report = Self {
            format: FORMAT,
            title: title.into(),
            rows: Vec::new(),
        };
        report.extend(rows)?;
        Ok(report)
    }

    /// Adds rows, for instance those of another run's report.
    ///
    /// # Errors
    /// As [`Report::new`]; the rows before the conflict are kept.
    pub fn extend(&mut self, rows: impl IntoIterator<Item = ResultRow>) -> Result<(), ReportError> {
        for row in rows {
            match self
                .rows
                .iter()
                .find(|known| known.conditions == row.conditions)
            {
                None => self.rows.push(row),
                Some(known) if known.scores == row.scores => {}
                Some(known) => {
                    return Err(ReportError::Conflict {
                        row: row.conditions.label(),
                        fold: row.conditions.fold,
                        first: known.scores.min_ade,
                        second: row.scores.min_ade,
                    });
                }
            }
        }
        Ok(())
    }

    /// The title.
    #[must_use]
    pub fn title(&self) -> &str {
        &self.title
    }

    /// The rows, in the order they were given.
    #[must_use]
    pub fn rows(&self) -> &[ResultRow] {
        &self.rows
    }

    /// The report as a page of markdown; its first line names the data convention of the numbers.
    #[must_use]
    pub fn to_markdown(&self) -> String {
        self.document().to_markdown()
    }

    /// The report as a document, to be rendered as markdown, HTML or LaTeX.
    #[must_use]
    pub fn document(&self) -> Document {
        content::document(&self.title, &self.rows)
    }

    /// The report as JSON, a line a row, from which [`Report::from_json`] makes the same report, bit by bit.
    ///
    /// # Errors
    /// None in practice: scores are finite.
    pub fn to_json(&self) -> Result<String, ReportError> {
        let rows: Vec<String> = self
            .rows
            .iter()
            .map(serde_json::to_string)
            .collect::<Result<_, _>>()?;
        let title = serde_json::to_string(&self.title)?;
        Ok(format!(
            "{{\"format\":{},\"title\":{title},\"rows\":[\n{}\n]}}\n",
            self.format,
            rows.join(",\n")
        ))
    }

    /// Reads what [`Report::to_json`] wrote.
    ///
    /// # Errors
    /// The text is not a report, is of a newer format, or holds conflicting rows.
    pub fn from_json(text: &str) -> Result<Self, ReportError> {
        let read: Self = serde_json::from_str(text)?;
        if read.format != FORMAT {
            return Err(ReportError::Format {
                found: read.format,
                supported: FORMAT,
            });
        }
        Self::new(read.title, read.rows)
    }

    /// Writes `report.md`, `report.tex` (its tables for a paper) and `report.json` into `folder`, which is created if need be. Each file is
    /// written under another name and renamed, so that none is ever there by half.
    ///
    /// # Errors
    /// The folder or a file cannot be written.
    pub fn save(&self, folder: &Path) -> Result<(), ReportError> {
        std::fs::create_dir_all(folder).map_err(|source| in_file(folder, source))?;
        let document = self.document();
        for (name, text) in [
            ("report.md", document.to_markdown()),
            ("report.tex", document.to_latex()),
            ("report.json", self.to_json()?),
        ] {
            let path = folder.join(name);
            write_whole(folder, &path, &text).map_err(|source| in_file(&path, source))?;
        }
        Ok(())
    }

    /// Reads a `report.json`.
    ///
    /// # Errors
    /// The file cannot be read, or as [`Report::from_json`].
    pub fn load(path: &Path) -> Result<Self, ReportError> {
        let text = std::fs::read_to_string(path).map_err(|source| in_file(path, source))?;
        Self::from_json(&text)
    }
}

fn in_file(path: &Path, source: std::io::Error) -> ReportError {
    ReportError::File {
        path: path.to_owned(),
        source,
    }
}

fn write_whole(folder: &Path, path: &Path, text: &str) -> std::io::Result<()> {
    let mut builder = tempfile::Builder::new();
    let builder = builder.prefix(".report-");
    // Temporary files are private by default; results are as readable as the user's other files.
    #[cfg(unix)]
    let builder = builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    let mut file = builder.tempfile_in(folder)?;
    file.write_all(text.as_bytes())?;
    file.as_file().sync_all()?;
    file.persist(path)?;
    Ok(())
}
