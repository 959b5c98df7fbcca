//! What a scene memory refuses, said with the place and the remedy.

use std::path::PathBuf;

use ddl_data::LiveError;
use thiserror::Error;

use crate::memory::LARGEST_CAPACITY;

/// Why a memory cannot be made, fed, written or read. After an error of `observe` the memory is unchanged.
#[derive(Debug, Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the messages say what the fields are")]
pub enum MemoryError {
    /// The frame step or a frame, as `ddl_data::LiveTracks` would refuse it.
    #[error(transparent)]
    Frame(#[from] LiveError),
    #[error(
        "the memory has {memory} raw frames in a step of 0.4 s, the recording {recording}: a memory is of one frame rate"
    )]
    OtherFrameStep { memory: i64, recording: i64 },
    #[error("the capacity must lie in 1..={LARGEST_CAPACITY} stretches, found {found}")]
    Capacity { found: usize },
    #[error("cannot write {}: {source}", .path.display())]
    Write {
        path: PathBuf,
        source: std::io::Error,
    },
    #[error("cannot read {}: {source}", .path.display())]
    Read {
        path: PathBuf,
        source: std::io::Error,
    },
    #[error(
        "{} is not a scene memory that can be read: {problem}. Put back a copy, or remove the file and start with an \
         empty memory",
        .path.display()
    )]
    File { path: PathBuf, problem: String },
}
