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
        Self {
            field: NonZeroU32::new(field),
            ..Self::line(line)
        }
    }

    pub(super) fn line_number(self) -> usize {
        self.line as usize
    }

    pub(super) fn wrong(self, origin: &str, problem: impl Into<String>) -> FormatError {
        FormatError {
            origin: origin.to_owned(),
            line: self.line_number(),
            field: self.field.map(|field| field.get() as usize),
            problem: problem.into(),
        }
    }

    pub(super) fn read<T>(self, origin: &str, read: Result<T, String>) -> Result<T, FormatError> {
        read.map_err(|problem| self.wrong(origin, problem))
    }
}
