//! Lines of a text of any size, read one at a time.

use std::io::{BufRead, Read as _};

use crate::file_error::DataError;
use crate::format::fault::{Fault, FormatError};
use crate::format::problem::NOT_UTF8;

/// The lines of a text, each at most so long. After an error the next line can be read.
#[derive(Debug)]
pub struct TextLines<R> {
    reader: R,
    origin: String,
    /// Bytes of the longest line that is read, and what is said of longer ones.
    longest: usize,
    advice: &'static str,
    number: usize,
    line: Vec<u8>,
}

impl<R: BufRead> TextLines<R> {
    /// Lines of at most `longest` bytes; `origin` names the text in messages, and `advice` is given on longer lines.
    pub fn new(reader: R, origin: impl Into<String>, longest: usize, advice: &'static str) -> Self {
        Self { reader, origin: origin.into(), longest, advice, number: 0, line: Vec::new() }
    }

    /// The name of the text.
    pub fn origin(&self) -> &str {
        &self.origin
    }

    /// The number of the last line, counted from 1.
    pub fn number(&self) -> usize {
        self.number
    }

    /// The next line, with its ending; `None` at the end of the text.
    ///
    /// # Errors
    /// If the text cannot be read, or the line is too long or not UTF-8.
    pub fn next_line(&mut self) -> Result<Option<&str>, DataError> {
        if self.advance()? { self.text().map(Some) } else { Ok(None) }
    }

    /// The next line that is not blank, without blanks around it; `None` at the end of the text.
    ///
    /// # Errors
    /// As [`next_line`](Self::next_line).
    pub fn next_filled(&mut self) -> Result<Option<&str>, DataError> {
        while self.advance()? {
            if !self.line.trim_ascii().is_empty() {
                return self.text().map(|text| Some(text.trim()));
            }
        }
        Ok(None)
    }

    /// The error of a fault in the last line.
    pub fn wrong(&self, fault: impl Into<Fault>) -> FormatError {
        fault.into().in_line(&self.origin, self.number)
    }

    /// Reads a line; `false` at the end.
    fn advance(&mut self) -> Result<bool, DataError> {
        if !self.take()? {
            return Ok(false);
        }
        self.number += 1;
        // Spreadsheets begin UTF-8 text with a byte-order mark, which is not part of it.
        while self.number == 1 && self.line.starts_with(b"\xef\xbb\xbf") {
            self.line.drain(..3);
        }
        if self.line.len() <= self.longest {
            return Ok(true);
        }
        while self.line.last() != Some(&b'\n') && self.take()? {}
        let (longest, advice) = (self.longest, self.advice);
        Err(self.wrong(format!("the line is longer than {longest} bytes; {advice}")).into())
    }

    /// Reads up to the end of a line, or a little more than the longest; `false` at the end.
    fn take(&mut self) -> Result<bool, DataError> {
        self.line.clear();
        let mut limited = self.reader.by_ref().take(self.longest as u64 + 1);
        match limited.read_until(b'\n', &mut self.line) {
            Ok(length) => Ok(length > 0),
            Err(source) => Err(DataError::Read { path: self.origin.clone().into(), source }),
        }
    }

    fn text(&self) -> Result<&str, DataError> {
        std::str::from_utf8(&self.line).map_err(|_| self.wrong(NOT_UTF8).into())
    }
}
