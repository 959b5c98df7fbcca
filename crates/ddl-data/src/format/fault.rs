//! What is wrong in a text, and where.

use std::borrow::Cow;
use std::fmt::{self, Display, Formatter};
use std::num::NonZeroU32;

use thiserror::Error;

/// What is wrong with a line or a field of a text; the message says how to solve it.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum Problem {
    /// A value is another than it must be.
    #[error("{0}")]
    Value(Box<WrongValue>),
    /// Another problem, in words.
    #[error("{0}")]
    Other(Cow<'static, str>),
}

/// A value that is another than it must be.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct WrongValue {
    /// Its name, where the field has none.
    pub name: Option<String>,
    /// What is right.
    pub wanted: Cow<'static, str>,
    /// A piece of what was found.
    pub found: String,
    /// What may be done, behind a semicolon; often empty.
    pub advice: Cow<'static, str>,
}

impl Display for WrongValue {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let (name, space) = self.name.as_deref().map_or(("", ""), |name| (name, " "));
        write!(f, "{name}{space}must be {}, found {}{}", self.wanted, self.found, self.advice)
    }
}

impl Problem {
    /// A value of this name that must be another; `found` is printed as it is.
    pub fn value(name: &str, wanted: impl Into<Cow<'static, str>>, found: impl Into<String>) -> Self {
        let name = (!name.is_empty()).then(|| name.to_owned());
        Self::Value(Box::new(WrongValue { name, wanted: wanted.into(), found: found.into(), advice: "".into() }))
    }

    /// The same with advice after it.
    #[must_use]
    pub fn and(self, advice: impl Into<Cow<'static, str>>) -> Self {
        let advice = advice.into();
        match self {
            Self::Value(mut value) => {
                value.advice = if value.advice.is_empty() { advice } else { value.advice + advice };
                Self::Value(value)
            }
            Self::Other(text) => Self::Other(text + advice),
        }
    }
}

impl<T: Into<Cow<'static, str>>> From<T> for Problem {
    fn from(text: T) -> Self {
        Self::Other(text.into())
    }
}

/// A field of a line.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Field {
    /// Its number, counted from 1.
    Number(usize),
    /// Its name.
    Name(String),
}

impl Field {
    /// The field at an index, counted from 0.
    pub(super) fn at(index: usize) -> Self {
        Self::Number(index + 1)
    }
}

impl Display for Field {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(number) => write!(f, "field {number}"),
            Self::Name(name) => f.write_str(name),
        }
    }
}

/// What is wrong with a line, in a text that the caller knows.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Fault {
    /// The field; `None` when the problem concerns the whole line.
    pub field: Option<Field>,
    /// What is wrong, and how to solve it.
    pub problem: Problem,
}

impl Fault {
    /// A fault of a field with a name.
    pub fn named(name: impl Into<String>, problem: impl Into<Problem>) -> Self {
        Self { field: Some(Field::Name(name.into())), problem: problem.into() }
    }

    /// A fault of a field, counted from 0.
    pub(super) fn at(index: usize, problem: impl Into<Problem>) -> Self {
        Self { field: Some(Field::at(index)), problem: problem.into() }
    }

    /// The same with advice after it.
    #[must_use]
    pub(super) fn and(self, advice: impl Into<Cow<'static, str>>) -> Self {
        Self { problem: self.problem.and(advice), ..self }
    }

    /// The error of a line, counted from 1; `origin` names the text.
    pub fn in_line(self, origin: &str, line: usize) -> FormatError {
        FormatError { origin: origin.to_owned(), line, field: self.field, problem: self.problem }
    }
}

/// A fault of the whole line.
impl<T: Into<Problem>> From<T> for Fault {
    fn from(problem: T) -> Self {
        Self { field: None, problem: problem.into() }
    }
}

/// A text cannot be read: its name, the line, the field and the problem.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("{origin}, line {line}{}: {problem}", .field.as_ref().map(|field| format!(", {field}")).unwrap_or_default())]
pub struct FormatError {
    /// The file name, or the name given for the bytes.
    pub origin: String,
    /// Line, counted from 1.
    pub line: usize,
    /// The field; `None` when the problem concerns the whole line.
    pub field: Option<Field>,
    /// What is wrong, and how to solve it.
    pub problem: Problem,
}

impl FormatError {
    /// The error of a text with this name.
    pub(super) fn in_text(self, origin: &str) -> Self {
        Self { origin: origin.to_owned(), ..self }
    }

    /// The same with advice after it.
    pub(super) fn and(self, advice: impl Into<Cow<'static, str>>) -> Self {
        Self { problem: self.problem.and(advice), ..self }
    }
}

/// A place within a text, both counted from 1. It is small, because every row has one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct FilePlace {
    line: u32,
    field: Option<NonZeroU32>,
}

impl FilePlace {
    pub(super) fn line(line: usize) -> Self {
        Self { line: u32::try_from(line).unwrap_or(u32::MAX), field: None }
    }

    pub(super) fn field(line: usize, field: usize) -> Self {
        Self { field: NonZeroU32::new(u32::try_from(field).unwrap_or(u32::MAX)), ..Self::line(line) }
    }

    pub(super) fn line_number(self) -> usize {
        self.line as usize
    }

    /// What is wrong here, in a text without a name, which the reader of the file adds.
    pub(super) fn wrong(self, fault: impl Into<Fault>) -> FormatError {
        let Fault { field, problem } = fault.into();
        let here = self.field.map(|field| Field::Number(field.get() as usize));
        Fault { field: field.or(here), problem }.in_line("", self.line_number())
    }

    pub(super) fn read<T>(self, read: Result<T, impl Into<Fault>>) -> Result<T, FormatError> {
        read.map_err(|fault| self.wrong(fault))
    }
}
