//! The lines of a file as the csv reader takes them: one at a time.

use std::cell::RefCell;
use std::io::{self, BufRead, Read};
use std::rc::Rc;

use super::error::ForeignError;
use super::lines::Lines;

/// What a reader of lines and the user of the csv reader around it tell each other.
#[derive(Debug, Default)]
pub(super) struct Reached {
    /// Number of the last line given out, from 1.
    pub(super) line: usize,
    /// Whether a line may be given out: a second one within a row means an open quote.
    pub(super) may_go_on: bool,
    /// Whether such a second line was asked for.
    pub(super) asked_for_more: bool,
    /// What is wrong with the file.
    pub(super) wrong: Option<ForeignError>,
}

/// Gives out no more than one line a call. The csv reader around it never holds a line beyond its row, so that the number of a
/// row's line is exact after blank lines too, and an open quote does not swallow the file.
#[derive(Debug)]
pub(super) struct OneLine<R> {
    lines: Lines<R>,
    reached: Rc<RefCell<Reached>>,
    line: Vec<u8>,
    given: usize,
}

impl<R> OneLine<R> {
    pub(super) fn new(lines: Lines<R>, reached: Rc<RefCell<Reached>>) -> Self {
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
