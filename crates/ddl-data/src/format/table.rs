//! The table: comma-separated, with a header, for one's own tracks.

use csv::{ErrorKind, StringRecord};

use super::rows::{FIELDS, Row};
use super::{Place, field};
use crate::error::{FormatError, FormatProblem};

const COLUMNS: [&str; 4] = ["frame", "pedestrian", "x", "y"];
/// The fields of a row that has too many of them.
const FEWER: &str =
    "frame, pedestrian, x, y; a decimal comma would part a number in two, write a point";

/// What the fields of a row hold, for one that has too few or too many.
fn names(expected: usize, found: usize) -> &'static str {
    if found > expected { FEWER } else { FIELDS }
}

pub(super) fn parse(text: &str, origin: &str) -> Result<Vec<Row>, FormatError> {
    if text.trim().is_empty() {
        return Err(Place {
            line: 1,
            field: None,
        }
        .wrong(origin, FormatProblem::Empty));
    }
    let mut reader = csv::ReaderBuilder::new()
        .trim(csv::Trim::All)
        .from_reader(text.as_bytes());
    let header = reader.headers().map_err(|e| table_error(&e, origin))?;
    let columns = Columns::of(header, 1, origin)?;
    let mut rows = Vec::new();
    for record in reader.records() {
        let record = record.map_err(|e| table_error(&e, origin))?;
        let line = record.position().map_or(1, |p| p.line() as usize);
        rows.push(columns.row(&record, line, origin)?);
    }
    Ok(rows)
}

/// Which column holds what.
#[derive(Debug)]
pub(super) struct Columns {
    places: [usize; 4],
    count: usize,
}

impl Columns {
    /// The columns that a header line names.
    pub(super) fn of_line(text: &str, line: usize, origin: &str) -> Result<Self, FormatError> {
        Self::of(&record(text, line, origin)?, line, origin)
    }

    /// A row on a line of its own.
    pub(super) fn row_of_line(
        &self,
        text: &str,
        line: usize,
        origin: &str,
    ) -> Result<Row, FormatError> {
        let record = record(text, line, origin)?;
        if record.len() != self.count {
            let problem = FormatProblem::FieldCount {
                expected: self.count,
                found: record.len(),
                names: names(self.count, record.len()),
            };
            return Err(Place { line, field: None }.wrong(origin, problem));
        }
        self.row(&record, line, origin)
    }

    fn of(header: &StringRecord, line: usize, origin: &str) -> Result<Self, FormatError> {
        let wrong = |field: Option<usize>, detail: String| {
            Place { line, field }.wrong(origin, FormatProblem::Header { detail })
        };
        if header.iter().all(|name| name.parse::<f64>().is_ok()) {
            let detail =
                "these are numbers; put the line frame,pedestrian,x,y above them".to_owned();
            return Err(wrong(None, detail));
        }
        let mut places = [None; 4];
        for (index, name) in header.iter().enumerate() {
            // Spreadsheets like capitals.
            let column = COLUMNS.iter().position(|c| name.eq_ignore_ascii_case(c));
            let Some(column) = column else {
                let detail = format!("unknown column {name:?}; {}", advice(name));
                return Err(wrong(Some(index + 1), detail));
            };
            if places[column].replace(index).is_some() {
                return Err(wrong(
                    Some(index + 1),
                    format!("column {name} is there twice"),
                ));
            }
        }
        let mut columns = [0; 4];
        for ((column, place), name) in columns.iter_mut().zip(places).zip(COLUMNS) {
            *column = place.ok_or_else(|| wrong(None, format!("column {name} is missing")))?;
        }
        Ok(Self {
            places: columns,
            count: header.len(),
        })
    }

    fn row(&self, record: &StringRecord, line: usize, origin: &str) -> Result<Row, FormatError> {
        let [frame, pedestrian, x, y] = self.places;
        let text = |column: usize| record.get(column).unwrap_or_default();
        let at = |column: usize| {
            move |p| {
                Place {
                    line,
                    field: Some(column + 1),
                }
                .wrong(origin, p)
            }
        };
        let place = Place { line, field: None };
        Ok(Row::new(
            field::integer(text(frame), "frame").map_err(at(frame))?,
            field::integer(text(pedestrian), "pedestrian").map_err(at(pedestrian))?,
            [
                field::coordinate(text(x), "x").map_err(at(x))?,
                field::coordinate(text(y), "y").map_err(at(y))?,
            ],
            place,
        ))
    }
}

/// What to do about a column that is none of the four.
fn advice(name: &str) -> &'static str {
    match name.to_ascii_lowercase().as_str() {
        "id" | "ped" | "ped_id" | "agent" | "agent_id" | "track" | "track_id" => {
            "rename it pedestrian"
        }
        "t" | "time" | "frame_id" => "rename it frame, and count frames",
        text if text.contains(';') => "separate columns by commas, and write decimals with a point",
        _ => "leave it out",
    }
}

/// The fields of one line.
fn record(text: &str, line: usize, origin: &str) -> Result<StringRecord, FormatError> {
    // A reader of tables is costly to make for every line of a stream, and without quotes there is nothing that it knows better.
    let plain = text.trim_end_matches(['\r', '\n']);
    if !plain.contains(['"', '\r', '\n']) {
        return Ok(plain.split(',').map(str::trim).collect());
    }
    quoted_record(text, line, origin)
}

fn quoted_record(text: &str, line: usize, origin: &str) -> Result<StringRecord, FormatError> {
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .trim(csv::Trim::All)
        .from_reader(text.as_bytes());
    let mut record = StringRecord::new();
    let read = reader.read_record(&mut record);
    read.map(|_| record).map_err(|error| {
        let detail = error.to_string();
        Place { line, field: None }.wrong(origin, FormatProblem::Table { detail })
    })
}

fn table_error(error: &csv::Error, origin: &str) -> FormatError {
    let line = error.position().map_or(1, |p| p.line() as usize);
    let problem = match error.kind() {
        ErrorKind::UnequalLengths {
            expected_len, len, ..
        } => FormatProblem::FieldCount {
            expected: *expected_len as usize,
            found: *len as usize,
            names: names(*expected_len as usize, *len as usize),
        },
        _ => FormatProblem::Table {
            detail: error.to_string(),
        },
    };
    Place { line, field: None }.wrong(origin, problem)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Lines without quotes are split as the reader of tables splits them.
        #[test]
        fn plain_lines_are_read_as_any(text in "[a0., \t\u{a0}\r\n\"]{0,12}[a0,]\r?\n?") {
            let fields = record(&text, 1, "t").unwrap();
            prop_assert_eq!(fields, quoted_record(&text, 1, "t").unwrap());
        }
    }
}
