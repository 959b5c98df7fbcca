//! Errors of recordings; each message says where the problem is and how to solve it.

use ddl_core::{COORDINATE_LIMIT, PedestrianId, Position, is_frame};
use thiserror::Error;

use crate::clock::ClockError;

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
