//! Lines of a file of any size, read one at a time, and checks of their fields.

use std::io::{BufRead, Read as _};

use ddl_core::{COORDINATE_LIMIT, FRAME_LIMIT, HORIZON, Position};

use crate::external::error::ExternalError;

/// Longest line, bytes: twenty times the length of 20 hypotheses with certificates.
const LIMIT: usize = 4 << 20;
/// Longest piece of a file that an error message quotes, in characters.
const QUOTED: usize = 40;

/// The lines of a file that are not blank, with their numbers.
pub(super) struct Lines<R> {
    reader: R,
    origin: String,
    number: usize,
    line: Vec<u8>,
}

/// A problem with its field, if it has one.
pub(super) type Wrong = (Option<String>, String);

pub(super) fn whole_line(problem: impl Into<String>) -> Wrong {
    (None, problem.into())
}

pub(super) fn in_field(field: impl Into<String>, problem: impl Into<String>) -> Wrong {
    (Some(field.into()), problem.into())
}

pub(super) fn missing(field: impl Into<String>) -> Wrong {
    in_field(field, "is missing")
}

pub(super) fn not_finite(found: &str) -> String {
    format!("must be a finite number, found {found}; a model that diverged must be reported as such, not scored")
}

pub(super) fn wrong_length(found: usize) -> String {
    format!("{found} positions; a forecast has {HORIZON}, 0.4 s apart, after the last observed frame")
}

impl<R: BufRead> Lines<R> {
    pub(super) fn new(reader: R, origin: &str) -> Self {
        Self { reader, origin: origin.to_owned(), number: 0, line: Vec::new() }
    }

    /// The next line that is not blank, with its number from 1; `None` at the end of the file.
    pub(super) fn next_line(&mut self) -> Result<Option<(usize, &str)>, ExternalError> {
        loop {
            self.line.clear();
            self.number += 1;
            let mut limited = self.reader.by_ref().take(LIMIT as u64 + 1);
            let read = limited.read_until(b'\n', &mut self.line);
            let length = read.map_err(|source| ExternalError::Io { origin: self.origin.clone(), source })?;
            if length == 0 {
                return Ok(None);
            }
            if length > LIMIT {
                let problem = format!("the line is longer than {LIMIT} bytes; write one line for each pedestrian");
                return Err(self.wrong(self.number, whole_line(problem)));
            }
            if self.number == 1 && self.line.starts_with(b"\xef\xbb\xbf") {
                // Spreadsheets begin UTF-8 text with a byte-order mark, which is not part of the content.
                self.line.drain(..3);
            }
            if !self.line.trim_ascii().is_empty() {
                break;
            }
        }
        match std::str::from_utf8(&self.line) {
            Ok(text) => Ok(Some((self.number, text.trim()))),
            Err(_) => Err(self.wrong(self.number, whole_line("the text is not UTF-8"))),
        }
    }

    pub(super) fn wrong(&self, line: usize, what: Wrong) -> ExternalError {
        wrong(&self.origin, line, what)
    }
}

pub(super) fn wrong(origin: &str, line: usize, (field, problem): Wrong) -> ExternalError {
    ExternalError::Line { origin: origin.to_owned(), line, field, problem }
}

pub(super) fn whole(number: f64) -> Option<i64> {
    (number.fract() == 0.0 && number.abs() < FRAME_LIMIT as f64).then_some(number as i64)
}

/// Refuses a position so far away that later computations would overflow.
pub(super) fn within_bounds(position: Position, field: impl FnOnce() -> String) -> Result<(), Wrong> {
    let far = position.into_iter().find(|c| c.abs() > COORDINATE_LIMIT);
    match far {
        None => Ok(()),
        Some(found) => {
            let problem = format!("must lie within {COORDINATE_LIMIT} m of the origin, found {found}");
            Err(in_field(field(), problem))
        }
    }
}

pub(super) fn quoted(text: &str) -> String {
    match text.char_indices().nth(QUOTED) {
        Some((end, _)) => format!("{}...", &text[..end]),
        None => text.to_owned(),
    }
}
