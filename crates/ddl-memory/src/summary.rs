//! What a memory tells about itself.

use ddl_data::{Position, TIME_STEP};

use crate::SceneMemory;
use crate::track::Track;

/// What a memory holds and what it was fed.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct MemorySummary {
    /// Stretches held. None after many frames: are frames a whole number of steps of 0.4 s apart?
    pub stretches: usize,
    /// Pedestrians with a stretch that is held.
    pub tracks: usize,
    /// Pedestrians seen; who comes back after 3.2 s counts again.
    pub pedestrians: u64,
    /// Frames observed, empty ones included.
    pub frames: u64,
    /// Time watched, without interruptions (s).
    pub seconds: f64,
    /// Least and largest x and y of all positions (m); `None` without one.
    pub extent: Option<[Position; 2]>,
}

impl SceneMemory {
    /// What the memory holds.
    #[must_use]
    pub fn summary(&self) -> MemorySummary {
        MemorySummary {
            stretches: self.stretches,
            tracks: self.held().count(),
            pedestrians: self.seen.pedestrians,
            frames: self.seen.frames,
            seconds: self.seen.watched as f64 * TIME_STEP / self.frame_step as f64,
            extent: self.seen.extent,
        }
    }

    /// The positions held of each pedestrian with a stretch (m), a step of 0.4 s apart but where steps were missed or
    /// forgotten: first those who left, in the order in which they did, then those who are there, by id.
    pub fn tracks(&self) -> impl Iterator<Item = Vec<Position>> {
        self.held().map(Track::positions)
    }

    fn held(&self) -> impl Iterator<Item = &Track> {
        let running = self.running.values().map(|running| &running.track);
        let tracks = self.ended.iter().chain(running);
        tracks.filter(|track| track.stretches() > 0)
    }
}
