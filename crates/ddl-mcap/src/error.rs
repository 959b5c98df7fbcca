//! Errors of this crate.

use ddl_data::escaped;

/// A log cannot be read or written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the messages say what the fields are")]
pub enum LogError {
    #[error("{place}: {problem}")]
    Read { place: String, problem: String },
    #[error("cannot write MCAP: {0}")]
    Write(#[from] mcap::McapError),
    #[error(transparent)]
    Encode(#[from] ddl_ros::RosError),
    #[error(
        "the moment {microseconds} us is before 0, where the times of MCAP begin; count times from 0, or write csv"
    )]
    Early { microseconds: i64 },
}

impl LogError {
    /// A way to say where a problem is.
    pub(crate) fn at(place: impl ToString) -> impl FnOnce(String) -> Self {
        move |problem| Self::Read { place: escaped(&place.to_string()), problem: escaped(&problem) }
    }
}
