//! Files of text with one observation per line.

use crate::format::choice::ColumnChoice;
use crate::format::comments::{is_comment, rate_of};
use crate::format::kind::Format;
use crate::format::place::{FilePlace, Misread};
use crate::format::problem::EMPTY;
use crate::format::rows::TrackRow;
use crate::format::track_columns::TrackColumns;

/// Rows for which memory is reserved before they are read.
const MOST_RESERVED: usize = 1 << 20;
/// Bytes of the shortest row.
const SHORTEST_ROW: usize = 7;

#[derive(Debug)]
pub(super) struct TextFile {
    pub(super) rows: Vec<TrackRow>,
    pub(super) notes: Vec<String>,
    /// Frames a second (TrajNet++: rows), if the file states it.
    pub(super) rate: Option<f64>,
}

pub(super) fn parse(text: &str, format: Format, choice: &ColumnChoice) -> Result<TextFile, Misread> {
    // Old spreadsheets end lines with a carriage return alone.
    let end = if text.contains('\n') { '\n' } else { '\r' };
    let mut lines = (1..).zip(text.split(end)).filter(|(_, text)| !text.trim().is_empty());
    let mut comments = Vec::new();
    let (first_line, first) = loop {
        match lines.next() {
            None => return Err(FilePlace::line(1).wrong(EMPTY)),
            Some((_, text)) if is_comment(text) => comments.push(text),
            Some(line) => break line,
        }
    };
    let (mut columns, is_header) = TrackColumns::of((format, choice), &comments, first, first_line)?;
    let first = (!is_header).then_some((first_line, first));
    let rows = first.into_iter().chain(lines);
    let ends = text.bytes().filter(|&byte| byte == end as u8).count();
    let read = columns.all_rows(rows, (ends + 1).min(text.len() / SHORTEST_ROW).min(MOST_RESERVED))?;
    if read.is_empty()
        && let Some(rows) = columns.left_out()
    {
        return Err(FilePlace::line(first_line).wrong(format!("no row is left; {rows} (--keep)")));
    }
    Ok(TextFile {
        rows: read,
        notes: columns.notes_of_file(),
        rate: comments.iter().find_map(|comment| rate_of(comment)).or(columns.rate()),
    })
}
