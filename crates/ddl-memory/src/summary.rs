//! Summary of a scene memory.

use ddl_core::{Position, TIME_STEP};

use crate::memory::SceneMemory;
use crate::track::Track;

/// Content of a memory and statistics of its input.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct MemorySummary {
    /// Segments held. If it stays 0, check that the rows of a pedestrian are at most 1.2 s apart.
    pub segments: usize,
    /// Pedestrians with at least one segment.
    pub tracks: usize,
    /// Pedestrians seen; a pedestrian that returns after 3.2 s counts again.
    pub pedestrians: u64,
    /// Frames observed, empty ones included.
    pub frames: u64,
    /// Time observed, without interruptions (s).
    pub seconds: f64,
    /// Smallest and largest x and y of all positions (m); `None` without positions.
    pub extent: Option<[Position; 2]>,
}

impl SceneMemory {
    /// A summary of the memory.
    #[must_use]
    pub fn summary(&self) -> MemorySummary {
        MemorySummary {
            segments: self.segments,
            tracks: self.held().count(),
            pedestrians: self.seen.pedestrians,
            frames: self.seen.frames,
            seconds: self.seen.watched as f64 * TIME_STEP / self.frame_step as f64,
            extent: self.seen.extent,
        }
    }

    /// The positions (m) of each pedestrian with a segment, one step of 0.4 s apart except where steps were missed or
    /// forgotten, or the track began anew. Pedestrians that have left come first, in the order in which they left, then
    /// those present, by id.
    pub fn tracks(&self) -> impl Iterator<Item = Vec<Position>> {
        self.held().map(Track::positions)
    }

    fn held(&self) -> impl Iterator<Item = &Track> {
        let running = self.running.values().map(|running| &running.track);
        self.ended.iter().chain(running).filter(|track| track.segments() > 0)
    }
}
