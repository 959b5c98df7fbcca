//! Which numbers a memory takes, when it is fed and when it is read from a file.

use ddl_data::{COORDINATE_LIMIT, Position};

/// Frames are below this in size, as those of `ddl_data::LiveTracks`.
const FRAME_LIMIT: u64 = 1 << 53;
const FRAME_STEP_LIMIT: i64 = 1 << 31;
/// Stretches; of the shortest tracks they take 180 MB.
pub(crate) const LARGEST_CAPACITY: usize = 1 << 18;

pub(crate) fn is_frame(frame: i64) -> bool {
    frame.unsigned_abs() < FRAME_LIMIT
}

pub(crate) fn is_frame_step(step: i64) -> bool {
    (1..=FRAME_STEP_LIMIT).contains(&step)
}

pub(crate) fn is_capacity(capacity: usize) -> bool {
    (1..=LARGEST_CAPACITY).contains(&capacity)
}

/// Whether both coordinates are numbers within the limit; `NaN` is not.
pub(crate) fn is_near(position: Position) -> bool {
    position.iter().all(|x| x.abs() <= COORDINATE_LIMIT)
}
