//! Errors of sliding searches.

use thiserror::Error;

use crate::error::SoftDtwError;
use ddl_simd::InstructionSet;

/// A sliding search cannot be prepared or answered.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the messages say what the fields are")]
pub enum SlidingError {
    #[error("the window length is 0: a window needs at least one step")]
    EmptyWindow,
    #[error(
        "none of the {tracks} tracks has a window: one needs {length} steps with {min_following_steps} more behind it"
    )]
    NoWindows {
        tracks: usize,
        length: usize,
        min_following_steps: usize,
    },
    #[error("track {index}: {source}")]
    Track { index: usize, source: SoftDtwError },
    #[error("the query has {found} steps: the windows of this index have {length}")]
    QueryLength { found: usize, length: usize },
    #[error("query: {0}")]
    Query(SoftDtwError),
    #[error("query track {index} of the batch: {source}")]
    BatchQuery { index: usize, source: SoftDtwError },
    #[error("this machine has no {set} instructions: choose one of InstructionSet::available()")]
    InstructionSet { set: InstructionSet },
}
