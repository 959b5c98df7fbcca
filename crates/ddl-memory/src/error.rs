//! Errors of a scene memory.

use std::path::{Path, PathBuf};

use ddl_data::LiveError;
use thiserror::Error;

/// A memory cannot be created, updated, written or read. After an error of `observe` the memory is unchanged.
#[derive(Debug, Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the messages say what the fields are")]
pub enum MemoryError {
    /// The frame step or a frame is invalid, by the rules of `ddl_data::LiveTracks`.
    #[error(transparent)]
    Frame(#[from] LiveError),
    #[error(
        "the memory has {memory} raw frames per step of 0.4 s, the recording {recording}: use recordings of the \
         memory's frame rate"
    )]
    OtherFrameStep { memory: i64, recording: i64 },
    #[error(
        "the memory was made at {} frames per second ({memory} frames per step of 0.4 s), but these tracks have {} \
         ({camera} per step): use a memory of the same frame rate, or a new file", rate(*.memory), rate(*.camera)
    )]
    OtherRate { camera: i64, memory: i64 },
    #[error(
        "{}: another process, or a watch of this process that was not closed, writes this file; wait until it is done, \
         or choose another file",
        .path.display()
    )]
    Taken { path: PathBuf },
    #[error("{}: {error}", .path.display())]
    InFile { path: PathBuf, error: Box<Self> },
    #[error("the capacity is {capacity} segments: it must lie in 1..={largest}")]
    Capacity { capacity: usize, largest: usize },
    #[error("cannot write {}: {source}", .path.display())]
    Write { path: PathBuf, source: std::io::Error },
    #[error("cannot read {}: {source}", .path.display())]
    Read { path: PathBuf, source: std::io::Error },
    #[error(
        "{} is not a readable scene memory: {problem}. Restore a copy, or remove the file and start with an \
         empty memory",
        .path.display()
    )]
    File { path: PathBuf, problem: String },
}

/// What is wrong in the content of a memory file.
#[derive(Debug, Error)]
pub(crate) enum ContentFault {
    #[error("it does not begin with {0:?}")]
    Beginning(&'static str),
    #[error("it has more than {0} bytes, which no memory has")]
    TooLarge(u64),
    #[error("it is damaged or cut off: its SHA-256 differs from the one in its first line")]
    Damaged,
    #[error(transparent)]
    Json(#[from] serde_json::Error),
    #[error(transparent)]
    Numbers(#[from] Box<MemoryError>),
    #[error(transparent)]
    Frame(#[from] LiveError),
    #[error("{0}")]
    Tracks(&'static str),
    #[error("a run has {found} positions, it needs 1 to {most}")]
    Run { found: usize, most: usize },
    #[error("position {0:?} is too far from the origin")]
    Far(ddl_core::Position),
    #[error("it holds {segments} segments, more than its capacity {capacity}")]
    Segments { segments: usize, capacity: usize },
}

impl MemoryError {
    /// The error with the file that it is about.
    #[must_use]
    pub fn in_file(self, path: &Path) -> Self {
        Self::InFile { path: path.to_owned(), error: Box::new(self) }
    }
}

/// Frames per second, from the number of frames in a step of 0.4 s.
fn rate(frame_step: i64) -> f64 {
    frame_step as f64 / ddl_core::TIME_STEP
}
