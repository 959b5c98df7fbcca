//! Position of a field within a file.

use std::num::NonZeroU32;

use crate::error::FormatError;

/// A place within a file, both counted from 1. It is small, because every row has one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct FilePlace {
    line: u32,
    field: Option<NonZeroU32>,
}

impl FilePlace {
    pub(super) fn line(line: usize) -> Self {
        let line = u32::try_from(line).unwrap_or(u32::MAX);
        Self { line, field: None }
    }

    pub(super) fn field(line: usize, field: usize) -> Self {
        let field = u32::try_from(field).unwrap_or(u32::MAX);
        Self { field: NonZeroU32::new(field), ..Self::line(line) }
    }

    pub(super) fn line_number(self) -> usize {
        self.line as usize
    }

    pub(super) fn wrong(self, problem: impl Into<String>) -> Misread {
        let problem = problem.into();
        Misread { place: self, problem }
    }

    pub(super) fn read<T>(self, read: Result<T, String>) -> Result<T, Misread> {
        read.map_err(|problem| self.wrong(problem))
    }
}

/// What is wrong at a place, in a file that the callers know.
#[derive(Debug)]
pub(super) struct Misread {
    place: FilePlace,
    problem: String,
}

impl Misread {
    pub(super) fn is_in_line(&self, line: usize) -> bool {
        self.place.line_number() == line
    }

    pub(super) fn and(mut self, advice: &str) -> Self {
        self.problem += advice;
        self
    }

    pub(super) fn in_file(self, origin: &str) -> FormatError {
        FormatError {
            origin: origin.to_owned(),
            line: self.place.line_number(),
            field: self.place.field.map(|field| field.get() as usize),
            problem: self.problem,
        }
    }
}
