//! What can be wrong with the tracks, the windows or a query.

use thiserror::Error;

use crate::error::SoftDtwError;
use ddl_simd::InstructionSet;

/// Why a sliding search could not be prepared or answered.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum SlidingError {
    /// A window must have a length.
    #[error("the window length is 0: a window needs at least one step")]
    EmptyWindow,
    /// No track is long enough.
    #[error(
        "none of the {tracks} tracks has a window: one needs {length} steps with {tail} more behind it"
    )]
    NoWindows {
        /// Number of tracks that were given.
        tracks: usize,
        /// Steps of a window.
        length: usize,
        /// Steps that must follow a window.
        tail: usize,
    },
    /// A track holds a value that is not finite, or its windows have no value in `f64`.
    #[error("track {index}: {source}")]
    Track {
        /// Position of the track in the list that was given, from 0.
        index: usize,
        /// What is wrong with it (sequence y).
        source: SoftDtwError,
    },
    /// A single window was asked for, and the query is longer or shorter than one.
    #[error("the query has {found} steps: the windows of this index have {length}")]
    QueryLength {
        /// Steps of the query.
        found: usize,
        /// Steps of a window.
        length: usize,
    },
    /// The query holds a value that is not finite, or a distance to it cannot be represented.
    #[error("query: {0}")]
    Query(SoftDtwError),
    /// One of a batch of query tracks is not valid.
    #[error("query track {index} of the batch: {source}")]
    BatchQuery {
        /// Position of the track in the batch, from 0.
        index: usize,
        /// What is wrong with it (sequence x).
        source: SoftDtwError,
    },
    /// The machine lacks the instructions that were asked for.
    #[error("this machine has no {set} instructions: choose one of InstructionSet::available()")]
    InstructionSet {
        /// What was asked for.
        set: InstructionSet,
    },
}
