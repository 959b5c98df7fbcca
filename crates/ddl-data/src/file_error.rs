//! Errors of files of recordings; each message says where the problem is and how to solve it.

use std::path::PathBuf;

use thiserror::Error;

use crate::error::RecordingError;
use crate::format::FormatError;

/// A data set, or one of its files, cannot be loaded.
#[derive(Debug, Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the messages say what the fields are")]
pub enum DataError {
    #[error("cannot read {}: {source}", .path.display())]
    Read { path: PathBuf, source: std::io::Error },
    #[error(transparent)]
    Format(#[from] FormatError),
    #[error("recording {name}: {source}")]
    Recording { name: String, source: RecordingError },
    #[error(
        "the {convention} recordings were not found in {}. Put the files there, or name \
         their folder in the environment variable {variable}",
        .searched.join(", ")
    )]
    NotFound { convention: &'static str, searched: Vec<String>, variable: &'static str },
    #[error("the {0} convention has no files of fixed names; use `Dataset::simulated` or `Dataset::own`")]
    NoFiles(&'static str),
    #[error("{problem}")]
    Own { problem: String },
    #[error("no {kind} {name:?} in the {convention} convention; it has {}", .known.join(", "))]
    Unknown { kind: &'static str, convention: &'static str, name: String, known: Vec<String> },
    #[error("{name:?} is not one of these recordings: {}", .known.join(", "))]
    NotATrainingRecording { name: String, known: Vec<String> },
}
