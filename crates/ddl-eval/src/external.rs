//! Forecasts of another program: read from a file, matched with the windows of a fold, scored.
//!
//! Recording, raw number of the **last observed** frame (`observed_until`) and pedestrian identify a forecast.
//! `docs/your-model.md` describes the files. Errors name their line and field.

mod error;
mod expected;
mod hint;
mod json;
mod json_lines;
mod lines;
mod matched;
mod measure;
mod pedestrian_key;
mod samples;
mod table;
mod table_rows;
mod write;

use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::Path;

use ddl_core::Window;
use ddl_data::DataError;

pub use error::ExternalError;
pub use matched::{Coverage, Matched};
pub use measure::measure;
pub use samples::{read_samples, write_samples};
pub use write::{write_forecasts, write_windows};

use expected::ExpectedForecasts;

/// Format of a file of forecasts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum ExternalFormat {
    /// A JSON object for each pedestrian of a window, as [`write_forecasts`] and the program write it.
    JsonLines,
    /// A comma-separated table with a header and a row for each position, as the program writes it.
    Table,
}

impl ExternalFormat {
    /// The format of a file by its extension, in upper or lower case; JSON lines for other extensions.
    pub fn of_file(path: &Path) -> Self {
        match path.extension() {
            Some(extension) if extension.eq_ignore_ascii_case("csv") => Self::Table,
            _ => Self::JsonLines,
        }
    }
}

/// Reads a file of forecasts and matches it with windows.
///
/// # Errors
/// The file cannot be read, or a line has an error, whose place is named. Without [`Coverage::Intersection`] also when
/// a pedestrian has no forecast, or a forecast matches no pedestrian of the windows.
pub fn read(
    path: &Path,
    format: ExternalFormat,
    windows: &[Window],
    coverage: Coverage,
) -> Result<Matched, ExternalError> {
    let file = File::open(path).map_err(|source| DataError::Read { path: path.to_owned(), source })?;
    let origin = path.display().to_string();
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let mut matched = read_from(BufReader::with_capacity(1 << 20, file), &origin, format, windows, coverage)?;
    matched.file = name.into_owned();
    Ok(matched)
}

/// [`read`] for any reader; `origin` is the file's name in error messages.
///
/// # Errors
/// As [`read`].
pub fn read_from(
    reader: impl BufRead,
    origin: &str,
    format: ExternalFormat,
    windows: &[Window],
    coverage: Coverage,
) -> Result<Matched, ExternalError> {
    let mut expected = ExpectedForecasts::of(windows, origin)?;
    let lines = lines::lines_of(reader, origin);
    match format {
        ExternalFormat::JsonLines => json_lines::read(lines, &mut expected),
        ExternalFormat::Table => table::read(lines, &mut expected),
    }?;
    expected.matched(coverage)
}
