//! Files of text with one observation per line.

use ddl_core::Setting;

use crate::format::choice::ColumnChoice;
use crate::format::column_names::is_known;
use crate::format::comments::{is_comment, rate_of};
use crate::format::fault::{FilePlace, FormatError};
use crate::format::header::ColumnRoles;
use crate::format::kind::Format;
use crate::format::problem::EMPTY;
use crate::format::row_reader::RowReader;
use crate::format::rows::TrackRow;
use crate::format::separator::Separator;
use crate::format::track_columns::TrackColumns;

/// Rows for which memory is reserved before they are read.
const MOST_RESERVED: usize = 1 << 20;
/// Lines of titles above the header that are looked at.
const MOST_TITLES: usize = 50;
/// Fields of a line that may be a header below titles.
const MOST_FIELDS: usize = 1000;
/// Bytes of the shortest row.
const SHORTEST_ROW: usize = 7;

#[derive(Debug)]
pub(super) struct TextFile {
    pub(super) rows: Vec<TrackRow>,
    pub(super) notes: Vec<String>,
    /// Frames a second (TrajNet++: rows), if the file states it.
    pub(super) rate: Option<f64>,
    pub(super) reader: Option<RowReader>,
}

impl TextFile {
    pub(super) fn without_columns(
        rows: Vec<TrackRow>,
        notes: impl IntoIterator<Item = String>,
        rate: Option<f64>,
    ) -> Self {
        Self { rows, notes: notes.into_iter().collect(), rate, reader: None }
    }

    /// What else may be done about a pedestrian that is twice in one frame, in these lines.
    pub(super) fn advice_on_same(reader: Option<&RowReader>, bytes: &[u8], lines: [usize; 2]) -> String {
        let text = String::from_utf8_lossy(bytes);
        let row = |line: usize| text.split(end_of_lines(&text)).nth(line - 1).unwrap_or_default();
        reader.map_or_else(String::new, |reader| reader.advice_on_same(lines.map(row)))
    }
}

/// Old spreadsheets end lines with a carriage return alone.
pub(super) fn end_of_lines(text: &str) -> char {
    if text.contains('\n') { '\n' } else { '\r' }
}

/// The number of a line below this one that names the columns of a table, if all lines above it are titles.
fn header_below(text: &str, line: usize, choice: &ColumnChoice) -> Option<usize> {
    let lines = (1..).zip(text.split(end_of_lines(text))).skip(line - 1);
    for (number, text) in lines.take(MOST_TITLES).filter(|(_, text)| !text.trim().is_empty()) {
        let fields = Separator::of(text).fields(text).unwrap_or_default();
        let names: Vec<&str> = fields.iter().map(|field| &**field).collect();
        if number > line && names.len() <= MOST_FIELDS && ColumnRoles::of_names(&names, choice).is_ok() {
            return Some(number);
        }
        let numbers = names.iter().filter(|name| name.parse::<f64>().is_ok()).count();
        if 2 * numbers > names.len() || number == line && names.iter().any(|name| is_known(name)) {
            return None;
        }
    }
    None
}

pub(super) fn parse(text: &str, format: Format, choice: &ColumnChoice) -> Result<TextFile, FormatError> {
    let end = end_of_lines(text);
    let mut lines = (1..).zip(text.split(end)).filter(|(_, text)| !text.trim().is_empty());
    let mut comments = Vec::new();
    let (first_line, first) = loop {
        match lines.next() {
            None => return Err(FilePlace::line(1).wrong(EMPTY)),
            Some((_, text)) if is_comment(text) => comments.push(text),
            Some(line) => break line,
        }
    };
    let of_titles = |wrong: FormatError| match header_below(text, first_line, choice) {
        Some(below) if wrong.line == first_line => {
            wrong.and(format!("; line {below} names the columns: delete the lines above it"))
        }
        _ => wrong,
    };
    let columns = TrackColumns::of((format, choice), &comments, first, first_line);
    let (columns, is_header) = columns.map_err(of_titles)?;
    let rate = comments.iter().find_map(|comment| rate_of(comment)).or(columns.rate());
    let first = (!is_header).then_some((first_line, first));
    let ends = text.bytes().filter(|&byte| byte == end as u8).count();
    let most = (ends + 1).min(text.len() / SHORTEST_ROW).min(MOST_RESERVED);
    let (reader, rows) = RowReader::of_file(columns, first.into_iter().chain(lines), most).map_err(of_titles)?;
    if let (true, Some(left_out)) = (rows.is_empty(), reader.filter.left_out()) {
        return Err(FilePlace::line(first_line).wrong(format!("no row is left; {left_out} ({})", Setting::Keep)));
    }
    Ok(TextFile { rows, notes: reader.notes_of_file(), rate, reader: Some(reader) })
}
