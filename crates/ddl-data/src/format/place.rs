//! Position of a field within a file.

use crate::error::FormatError;
use crate::format::problem::FormatProblem;

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

    #[expect(clippy::needless_pass_by_value, reason = "a problem is reported once")]
    pub(super) fn wrong(self, origin: &str, problem: FormatProblem) -> FormatError {
        let Self { line, field } = self;
        FormatError {
            origin: origin.to_owned(),
            line,
            field,
            problem: problem.to_string(),
        }
    }

    pub(super) fn read<T>(self, origin: &str, read: Result<T, FormatProblem>) -> Result<T, FormatError> {
        read.map_err(|problem| self.wrong(origin, problem))
    }
}
