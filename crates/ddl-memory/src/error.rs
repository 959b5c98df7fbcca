//! What a scene memory refuses, said with the place and the remedy.

use std::path::PathBuf;

use ddl_data::{COORDINATE_LIMIT, PedestrianId, Position};
use thiserror::Error;

use crate::limits::LARGEST_CAPACITY;

/// Why a memory cannot be made, fed, written or read. After an error of `observe` the memory is unchanged.
#[derive(Debug, Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the messages say what the fields are")]
pub enum MemoryError {
    #[error("the frame step must lie in 1..=2^31 raw frames, found {found}")]
    FrameStep { found: i64 },
    #[error("the capacity must lie in 1..={LARGEST_CAPACITY} stretches, found {found}")]
    Capacity { found: usize },
    #[error("frame {frame} is not below 2^53 in size")]
    FrameOutOfRange { frame: i64 },
    #[error(
        "frame {frame} comes after frame {last}; give frames in order of time, each once, and call `interrupt` when \
         the tracker starts anew"
    )]
    TooEarly { frame: i64, last: i64 },
    #[error("frame {frame}, pedestrian {pedestrian}: {position:?} is not finite")]
    NotFinite {
        pedestrian: PedestrianId,
        frame: i64,
        position: Position,
    },
    #[error(
        "frame {frame}, pedestrian {pedestrian}: {position:?} does not lie within {COORDINATE_LIMIT} m of the origin; \
         use coordinates relative to a nearer origin"
    )]
    TooFar {
        pedestrian: PedestrianId,
        frame: i64,
        position: Position,
    },
    #[error("pedestrian {pedestrian} is in frame {frame} twice; keep one")]
    Duplicate {
        pedestrian: PedestrianId,
        frame: i64,
    },
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
