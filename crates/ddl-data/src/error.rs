//! Errors of recordings; each message says where the problem is and how to solve it.

use std::path::PathBuf;

use ddl_core::{COORDINATE_LIMIT, PedestrianId, Position, is_frame};
use thiserror::Error;

use crate::clock::ClockError;

/// A file of tracks cannot be read: the file, the line, the field and the problem.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("{origin}, line {line}{}: {problem}", .field.map(|f| format!(", field {f}")).unwrap_or_default())]
pub struct FormatError {
    /// The file name, or the name given for the bytes.
    pub origin: String,
    /// Line, counted from 1.
    pub line: usize,
    /// Field within the line, counted from 1; `None` when the problem concerns the whole line.
    pub field: Option<usize>,
    /// Text that describes the problem.
    pub problem: String,
}

/// Observations that cannot form a [`Recording`](crate::Recording).
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the messages say what the fields are")]
pub enum RecordingError {
    #[error("a recording needs at least one observation")]
    Empty,
    #[error("the frame step must lie in 1..=2^31 raw frames, found {found}")]
    FrameStep { found: i64 },
    #[error(transparent)]
    Row(#[from] LiveError),
}

/// A frame that cannot be added to [`LiveTracks`](crate::LiveTracks) or to a scene memory, which stay unchanged.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the messages say what the fields are")]
pub enum LiveError {
    #[error(transparent)]
    Clock(#[from] ClockError),
    #[error("frame {frame} is not below 2^53 in size")]
    FrameOutOfRange { frame: i64 },
    #[error(
        "frame {frame} comes after frame {last}; push frames in order of time, each once; when the tracker restarts, \
         clear the tracks, or end those of the memory, before its first frame"
    )]
    TooEarly { frame: i64, last: i64 },
    #[error(
        "frame {frame}, pedestrian {pedestrian}: {position:?} is no position; x and y are finite, and within \
         {COORDINATE_LIMIT} m of the origin"
    )]
    NoPosition { pedestrian: PedestrianId, frame: i64, position: Position },
    #[error(
        "more than {limit} pedestrians were seen within 2 s; does each keep its name from frame to frame, and is the \
         rate right?"
    )]
    TooManyPedestrians { limit: usize },
    #[error("pedestrian {pedestrian} is in frame {frame} twice; keep one position")]
    Duplicate { pedestrian: PedestrianId, frame: i64 },
}

impl LiveError {
    /// Checks the frame and the position of a row.
    pub(crate) fn check_row(frame: i64, pedestrian: PedestrianId, position: Position) -> Result<(), Self> {
        if !is_frame(frame) {
            return Err(Self::FrameOutOfRange { frame });
        }
        // False for NaN.
        if position.iter().all(|coordinate| coordinate.abs() <= COORDINATE_LIMIT) {
            return Ok(());
        }
        Err(Self::NoPosition { pedestrian, frame, position })
    }
}

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
