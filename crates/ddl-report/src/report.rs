//! Results of several runs: tables, and JSON for programs.

use crate::document::Document;
use crate::error::ReportError;
use ddl_data::Convention;
use ddl_eval::ResultRow;
use serde::{Deserialize, Serialize};
use std::path::Path;

mod ablation;
mod across_protocols;
mod categories;
mod cells;
mod content;
mod deployable;
mod group;
mod metrics;
mod published;
mod recordings;
mod section;
mod significance;
mod spread;
mod summary;

pub(crate) use group::{ResultGroup, TableLine, groups, order};

const FORMAT: u32 = 1;

/// Results of any number of runs.
///
/// Rows are grouped into one table for each data convention, window rule, protocol and test subset, so that every
/// column holds comparable numbers.
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
    pub fn new(title: impl Into<String>, rows: impl IntoIterator<Item = ResultRow>) -> Result<Self, ReportError> {
        let mut report = Self { format: FORMAT, title: title.into(), rows: Vec::new() };
        report.extend(rows)?;
        Ok(report)
    }

    /// Adds rows, for instance those of another run's report.
    ///
    /// # Errors
    /// As [`Report::new`]; the rows before the conflict are kept.
    pub fn extend(&mut self, rows: impl IntoIterator<Item = ResultRow>) -> Result<(), ReportError> {
        for row in rows {
            match self.rows.iter().find(|earlier| earlier.conditions == row.conditions) {
                None => self.rows.push(row),
                Some(earlier) if earlier.scores == row.scores => {}
                Some(earlier) => {
                    return Err(ReportError::Conflict {
                        row: row.conditions.label(),
                        fold: row.conditions.fold,
                        first: earlier.scores.min_ade,
                        second: row.scores.min_ade,
                    });
                }
            }
        }
        Ok(())
    }

    /// The title.
    pub fn title(&self) -> &str {
        &self.title
    }

    /// The rows, in the order they were given.
    pub fn rows(&self) -> &[ResultRow] {
        &self.rows
    }

    /// The report as markdown; its first line names the data convention of the numbers.
    pub fn to_markdown(&self) -> String {
        self.document().to_markdown()
    }

    /// The report as a document, for markdown or HTML.
    pub(crate) fn document(&self) -> Document {
        content::document(&self.title, &self.rows)
    }

    /// The main tables as markdown: a convention under its headline window rule, without the protocol `published`.
    /// `None` if the report has no such results.
    ///
    /// The first table has minADE/minFDE (m) of each fold, mean over the seeds, then the mean of the folds with the
    /// standard deviation over the seeds. A row that a second protocol repeats, such as that of a baseline, is given
    /// once. The last row is the best published system of the convention. The second table has, for the same rows over
    /// the measured folds, the mean errors with their 95 % intervals, and further metrics.
    pub fn summary(&self, convention: Convention) -> Option<String> {
        summary::in_words(&self.rows, convention)
    }

    /// The report as JSON, one line for each row. [`Report::from_json`] makes the same report from it, bit by bit.
    ///
    /// # Errors
    /// None in practice: scores are finite.
    pub fn to_json(&self) -> Result<String, ReportError> {
        let rows: Vec<String> = self.rows.iter().map(serde_json::to_string).collect::<Result<_, _>>()?;
        let title = serde_json::to_string(&self.title)?;
        Ok(format!("{{\"format\":{},\"title\":{title},\"rows\":[\n{}\n]}}\n", self.format, rows.join(",\n")))
    }

    /// Reads what [`Report::to_json`] wrote.
    ///
    /// # Errors
    /// The text is not a report, is of a newer format, or holds conflicting rows.
    pub fn from_json(text: &str) -> Result<Self, ReportError> {
        let read: Self = serde_json::from_str(text).map_err(ReportError::Json)?;
        if read.format != FORMAT {
            return Err(ReportError::Format { found: read.format, supported: FORMAT });
        }
        Self::new(read.title, read.rows)
    }

    /// The names and contents of its files: `report.md` and `report.json`.
    ///
    /// # Errors
    /// As [`Report::to_json`].
    pub fn files(&self) -> Result<[(&'static str, String); 2], ReportError> {
        Ok([("report.md", self.to_markdown()), ("report.json", self.to_json()?)])
    }

    /// Reads a `report.json`.
    ///
    /// # Errors
    /// The file cannot be read, or as [`Report::from_json`].
    pub fn load(path: &Path) -> Result<Self, ReportError> {
        let in_file = |source| ReportError::File { path: path.to_owned(), source };
        let text = std::fs::read_to_string(path).map_err(in_file)?;
        Self::from_json(&text)
            .map_err(|source| ReportError::Unreadable { path: path.to_owned(), source: Box::new(source) })
    }
}
