//! Position of a field within a file.

use crate::error::FormatError;

/// A place within a file, both counted from 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct FilePlace {
    pub(super) line: usize,
    pub(super) field: Option<usize>,
}

impl FilePlace {
    pub(super) fn line(line: usize) -> Self {
        Self { line, field: None }
    }

    pub(super) fn field(line: usize, field: usize) -> Self {
        let field = Some(field);
        Self { line, field }
    }

    pub(super) fn wrong(self, origin: &str, problem: impl Into<String>) -> FormatError {
        let Self { line, field } = self;
        FormatError {
            origin: origin.to_owned(),
            line,
            field,
            problem: problem.into(),
        }
    }

    pub(super) fn read<T>(self, origin: &str, read: Result<T, String>) -> Result<T, FormatError> {
        read.map_err(|problem| self.wrong(origin, problem))
    }
}
