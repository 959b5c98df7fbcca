//! The rows of a comma-separated file, with the numbers of their lines.

use std::io::BufRead;

use csv_core::{ReadRecordResult, Reader};
use ddl_data::{Fault, FormatError, TextLines};

use crate::external::error::ExternalError;

/// The rows of a table. Each is read from one line, so that an open quote does not include the rest of the file.
pub(super) struct TableRows<R> {
    lines: TextLines<R>,
    reader: Reader,
    /// The current line, and the start of its next row: a carriage return also ends a row.
    line: Vec<u8>,
    at: usize,
    fields: Vec<u8>,
    ends: Vec<usize>,
}

pub(super) struct Fields<'a> {
    text: &'a [u8],
    ends: &'a [usize],
}

impl Fields<'_> {
    pub(super) fn len(&self) -> usize {
        self.ends.len()
    }

    /// The trimmed field in a column; empty after the last column.
    pub(super) fn get(&self, column: usize) -> &str {
        let start = column.checked_sub(1).map_or(0, |before| self.ends[before]);
        // Lines are text, and fields end at commas and quotes.
        std::str::from_utf8(&self.text[start..self.ends[column]]).map_or("", str::trim)
    }
}

impl<R: BufRead> TableRows<R> {
    pub(super) fn new(lines: TextLines<R>) -> Self {
        Self { lines, reader: Reader::new(), line: Vec::new(), at: 0, fields: Vec::new(), ends: Vec::new() }
    }

    pub(super) fn next(&mut self) -> Result<Option<Fields<'_>>, ExternalError> {
        if self.at == self.line.len() {
            let Some(text) = self.lines.next_filled()? else { return Ok(None) };
            self.at = 0;
            self.line.clear();
            self.line.extend_from_slice(text.as_bytes());
            self.line.push(b'\n');
            // Fields are not longer than their line.
            self.fields.resize(self.line.len(), 0);
            self.ends.resize(self.line.len(), 0);
        }
        let line = &self.line[self.at..];
        let (result, read, _, count) = self.reader.read_record(line, &mut self.fields, &mut self.ends);
        self.at += read;
        if result != ReadRecordResult::Record {
            return Err(self.wrong("a quote is not closed on this line").into());
        }
        Ok(Some(Fields { text: &self.fields, ends: &self.ends[..count] }))
    }

    /// The number of the current line.
    pub(super) fn number(&self) -> usize {
        self.lines.number()
    }

    /// The error of a fault in the current line.
    pub(super) fn wrong(&self, fault: impl Into<Fault>) -> FormatError {
        self.lines.wrong(fault)
    }
}
