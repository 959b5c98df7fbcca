//! The rows of a comma-separated file, each on a line of its own, with the numbers of their lines.

use std::cell::RefCell;
use std::io::{self, BufRead, Read};
use std::rc::Rc;

use csv::StringRecord;

use super::error::{ForeignError, ForeignProblem};
use super::lines::{self, Lines, Wrong, whole_line};

/// A value with the number of its line.
pub(super) type AtLine<T> = (usize, T);

/// The rows of a table, with the numbers of their lines.
#[derive(Debug)]
pub(super) struct TableRows<R> {
    reader: csv::Reader<OneLine<R>>,
    reached: Rc<RefCell<Reached>>,
    origin: String,
}

impl<R: BufRead> TableRows<R> {
    pub(super) fn new(lines: Lines<R>) -> Self {
        let reached = Rc::new(RefCell::new(Reached::default()));
        let origin = lines.origin().to_owned();
        let reader = csv::ReaderBuilder::new()
            .has_headers(false)
            .flexible(true)
            .from_reader(OneLine::new(lines, Rc::clone(&reached)));
        Self {
            reader,
            reached,
            origin,
        }
    }

    /// Reads the next row, and says which line it is; `None` at the end of the file. Blanks around fields are left:
    /// the csv reader would copy each row once more to cut them off.
    pub(super) fn next(
        &mut self,
        record: &mut StringRecord,
    ) -> Result<Option<usize>, ForeignError> {
        self.reached.borrow_mut().may_go_on = true;
        let read = self.reader.read_record(record);
        let mut reached = self.reached.borrow_mut();
        match read {
            Ok(true) => Ok(Some(reached.line)),
            Ok(false) => Ok(None),
            Err(error) => {
                if let Some(wrong) = reached.wrong.take() {
                    return Err(wrong);
                }
                let problem = if reached.asked_for_more {
                    ForeignProblem::OpenQuote
                } else {
                    let detail = error.to_string();
                    ForeignProblem::Row { detail }
                };
                let wrong = whole_line(problem);
                Err(lines::wrong(&self.origin, reached.line, wrong))
            }
        }
    }

    /// The error that something is wrong with the row just read.
    pub(super) fn wrong(&self, wrong: Wrong) -> ForeignError {
        lines::wrong(&self.origin, self.reached.borrow().line, wrong)
    }

    pub(super) fn wrong_at(&self, (line, wrong): AtLine<Wrong>) -> ForeignError {
        lines::wrong(&self.origin, line, wrong)
    }
}

/// What a reader of lines and the user of the csv reader around it tell each other.
#[derive(Debug, Default)]
struct Reached {
    /// Number of the last line given out, from 1.
    line: usize,
    /// Whether a line may be given out: a second one within a row means an open quote.
    may_go_on: bool,
    /// Whether such a second line was asked for.
    asked_for_more: bool,
    /// What is wrong with the file.
    wrong: Option<ForeignError>,
}

/// Gives out no more than one line a call. The csv reader around it never holds a line beyond its row, so that the number of a
/// row's line is exact after blank lines too, and an open quote does not swallow the file.
#[derive(Debug)]
struct OneLine<R> {
    lines: Lines<R>,
    reached: Rc<RefCell<Reached>>,
    line: Vec<u8>,
    given: usize,
}

impl<R> OneLine<R> {
    fn new(lines: Lines<R>, reached: Rc<RefCell<Reached>>) -> Self {
        Self {
            lines,
            reached,
            line: Vec::new(),
            given: 0,
        }
    }
}

impl<R: BufRead> Read for OneLine<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if self.given == self.line.len() {
            let mut reached = self.reached.borrow_mut();
            if !reached.may_go_on {
                reached.asked_for_more = true;
                return Err(io::ErrorKind::Other.into());
            }
            match self.lines.next_line() {
                Ok(None) => return Ok(0),
                Ok(Some((number, text))) => {
                    (reached.line, reached.may_go_on) = (number, false);
                    self.line.clear();
                    self.line.extend_from_slice(text.as_bytes());
                    self.line.push(b'\n');
                    self.given = 0;
                }
                Err(error) => {
                    reached.wrong = Some(error);
                    return Err(io::ErrorKind::Other.into());
                }
            }
        }
        let left = &self.line[self.given..];
        let length = left.len().min(buffer.len());
        buffer[..length].copy_from_slice(&left[..length]);
        self.given += length;
        Ok(length)
    }
}
