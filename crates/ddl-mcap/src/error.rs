//! Errors of this crate.

use std::path::PathBuf;

/// A log cannot be read or written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the messages say what the fields are")]
pub enum LogError {
    #[error("cannot read {}: {source}", .path.display())]
    Read { path: PathBuf, source: std::io::Error },
    #[error("{place}: {problem}")]
    Content { place: String, problem: String },
    #[error("cannot write MCAP: {0}")]
    Write(#[from] mcap::McapError),
    #[error(transparent)]
    Encode(#[from] ddl_ros::RosError),
    #[error("the moment {microseconds} us is before 0, where the times of MCAP begin")]
    Early { microseconds: i64 },
}

impl LogError {
    pub(crate) fn at(place: impl Into<String>, problem: impl Into<String>) -> Self {
        Self::Content {
            place: place.into(),
            problem: problem.into(),
        }
    }
}
