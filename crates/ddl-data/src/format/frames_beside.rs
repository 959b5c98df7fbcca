//! A column of frames beside the times that are read.

use std::borrow::Cow;

use crate::clock::STAMPS_A_SECOND;
use crate::format::field;
use crate::format::place::{FilePlace, Misread};

/// Times may go back as far where frames go on: rows of several sensors are not in order.
const OUT_OF_ORDER: i64 = 2 * STAMPS_A_SECOND;

/// Finds times that begin again for each pedestrian while the frames go on: as one clock, people who never met would
/// be together.
#[derive(Debug)]
pub(super) struct FramesBeside {
    column: usize,
    before: Option<(i64, i64)>,
}

impl FramesBeside {
    pub(super) fn new(column: usize) -> Self {
        Self { column, before: None }
    }

    /// Compares a row and its time in microseconds with the row before.
    pub(super) fn check(&mut self, fields: &[Cow<'_, str>], time: i64, line: usize) -> Result<(), Misread> {
        let Ok(frame) = field::integer(&fields[self.column], "frame") else {
            return Ok(());
        };
        let before = self.before.replace((frame, time));
        if before.is_none_or(|(last, before)| frame < last || time >= before - OUT_OF_ORDER) {
            return Ok(());
        }
        let problem = "the time goes back while the frames go on: does it begin again for each pedestrian? --columns \
                       frame=NAME takes the frames, --columns time=NAME the times nevertheless";
        Err(FilePlace::line(line).wrong(problem))
    }
}
