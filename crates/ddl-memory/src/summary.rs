//! What a memory tells about itself.

use ddl_data::{Position, TIME_STEP};

use crate::SceneMemory;

/// What a memory holds and what it was fed.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct MemorySummary {
    /// Stretches held.
    pub stretches: usize,
    /// Pedestrians with a stretch that is held.
    pub tracks: usize,
    /// Pedestrians seen.
    pub pedestrians: u64,
    /// Frames observed, empty ones included.
    pub frames: u64,
    /// Positions observed.
    pub observations: u64,
    /// Time watched, without interruptions (s).
    pub seconds: f64,
    /// Least and largest x and y of all positions (m); `None` without an observation.
    pub corners: Option<[Position; 2]>,
}

impl SceneMemory {
    /// What the memory holds.
    #[must_use]
    pub fn summary(&self) -> MemorySummary {
        let running = self.running.values();
        let remembered = running.filter(|running| !running.track.pieces.is_empty());
        MemorySummary {
            stretches: self.stretches,
            tracks: self.ended.len() + remembered.count(),
            pedestrians: self.seen.pedestrians,
            frames: self.seen.frames,
            observations: self.seen.observations,
            seconds: self.seen.watched as f64 * TIME_STEP / self.frame_step as f64,
            corners: self.seen.corners,
        }
    }
}
