//! Errors of this crate.

use std::fmt::Display;

use ddl_data::{DataError, RecordingError, escaped};
use ddl_ros::RosError;
use mcap::McapError;

/// A log cannot be read or written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the messages say what the fields are")]
pub enum LogError {
    #[error("{}", escaped(&format!("{place}: {problem}")))]
    Read { place: String, problem: LogProblem },
    #[error("cannot write MCAP: {0}")]
    Write(#[from] McapError),
    #[error(transparent)]
    Encode(#[from] RosError),
    #[error(
        "the moment {microseconds} us is before 0, where the times of MCAP begin; count times from 0, or write csv"
    )]
    Early { microseconds: i64 },
}

/// What is wrong at a place of a log.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the messages say what is wrong")]
pub enum LogProblem {
    #[error(transparent)]
    Io(#[from] std::io::Error),
    #[error(transparent)]
    Record(#[from] McapError),
    #[error("a chunk is damaged: {0}")]
    Chunk(String),
    #[error(transparent)]
    Json(#[from] serde_json::Error),
    #[error(transparent)]
    Message(#[from] RosError),
    #[error(transparent)]
    Tracks(#[from] DataError),
    #[error(transparent)]
    Rows(#[from] RecordingError),
    /// Another problem, in words that say how to solve it.
    #[error("{0}")]
    Other(String),
}

impl From<String> for LogProblem {
    fn from(text: String) -> Self {
        Self::Other(text)
    }
}

impl From<&str> for LogProblem {
    fn from(text: &str) -> Self {
        Self::Other(text.to_owned())
    }
}

impl LogProblem {
    pub(crate) fn of_chunk(error: impl Display) -> Self {
        Self::Chunk(error.to_string())
    }

    /// The error at a place.
    pub(crate) fn at(self, place: impl Display) -> LogError {
        LogError::Read { place: place.to_string(), problem: self }
    }
}
