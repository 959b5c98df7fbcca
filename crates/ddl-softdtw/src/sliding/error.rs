//! What can be wrong with the tracks, the windows or a query.

use thiserror::Error;

use crate::error::SoftDtwError;
use ddl_simd::InstructionSet;

/// Why a sliding search could not be prepared or answered.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the messages say what the fields are")]
pub enum SlidingError {
    /// A window must have a length.
    #[error("the window length is 0: a window needs at least one step")]
    EmptyWindow,
    /// No track is long enough.
    #[error(
        "none of the {tracks} tracks has a window: one needs {length} steps with {tail} more behind it"
    )]
    NoWindows {
        tracks: usize,
        length: usize,
        tail: usize,
    },
    /// A track holds a value that is not finite, or its windows have no value in `f64`.
    #[error("track {index}: {source}")]
    Track { index: usize, source: SoftDtwError },
    /// A single window was asked for, and the query is longer or shorter than one.
    #[error("the query has {found} steps: the windows of this index have {length}")]
    QueryLength { found: usize, length: usize },
    /// The query holds a value that is not finite, or a distance to it cannot be represented.
    #[error("query: {0}")]
    Query(SoftDtwError),
    /// One of a batch of query tracks is not valid.
    #[error("query track {index} of the batch: {source}")]
    BatchQuery { index: usize, source: SoftDtwError },
    /// The machine lacks the instructions that were asked for.
    #[error("this machine has no {set} instructions: choose one of InstructionSet::available()")]
    InstructionSet { set: InstructionSet },
}
