//! One pedestrian's stretches, and the track of one who may be seen again.

use ddl_data::{PedestrianId, Position, WINDOW};

use crate::piece::{Motion, Piece};

/// After so many steps of 0.4 s (3.2 s in all) without a position a track ends. The same id later starts a new track.
pub const LONGEST_ABSENCE: i64 = 8;
/// Of one pedestrian at most so many runs of 8 stretches are kept, the latest: 102 s of somebody who stays.
pub const MOST_PIECES: usize = 32;

/// Positions of a stretch, and the one before them where it follows on another stretch.
pub(crate) const LONGEST_RUN: usize = WINDOW + 1;

/// A pedestrian of this memory.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Track {
    /// Pedestrians are counted as they come, those of one frame by their ids.
    pub(crate) number: u64,
    pub(crate) id: PedestrianId,
    /// Oldest first.
    pub(crate) pieces: Vec<Piece>,
}

impl Track {
    pub(crate) fn stretches(&self) -> usize {
        self.pieces.iter().map(Piece::len).sum()
    }

    /// The squared distance of its stretch that is nearest to a motion.
    pub(crate) fn nearest(&self, motion: &Motion) -> f32 {
        let distances = self.pieces.iter().map(|piece| piece.nearest(motion));
        distances.fold(f32::INFINITY, f32::min)
    }

    /// The first stretch at that distance from a motion.
    pub(crate) fn stretch_at(&self, motion: &Motion, distance: f32) -> Option<[Position; WINDOW]> {
        self.pieces.iter().find_map(|piece| {
            let distances = piece.distances(motion);
            let lane = distances.iter().position(|found| *found <= distance)?;
            Some(piece.stretch(lane))
        })
    }

    /// Removes the oldest piece and tells how many stretches it had.
    pub(crate) fn forget_oldest(&mut self) -> usize {
        if self.pieces.is_empty() {
            return 0;
        }
        self.pieces.remove(0).len()
    }
}

/// The track of somebody who was seen a short time ago.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct RunningTrack {
    pub(crate) track: Track,
    pub(crate) last_seen: i64,
    /// The last positions without a hole, a step apart, at most [`LONGEST_RUN`].
    pub(crate) run: Vec<Position>,
    /// The frame of the last of them.
    pub(crate) run_end: i64,
}

impl RunningTrack {
    pub(crate) fn new(number: u64, id: PedestrianId, frame: i64) -> Self {
        let pieces = Vec::new();
        Self {
            track: Track { number, id, pieces },
            last_seen: frame,
            run: Vec::with_capacity(LONGEST_RUN),
            run_end: frame,
        }
    }

    /// Whether the track has ended by this frame.
    pub(crate) fn is_gone(&self, frame: i64, step: i64) -> bool {
        frame - self.last_seen > LONGEST_ABSENCE * step
    }

    /// Adds a position. Returns whether a stretch is complete, for [`keep`](Self::keep).
    pub(crate) fn see(&mut self, frame: i64, position: Position, step: i64) -> bool {
        self.last_seen = frame;
        let due = self.run_end + step;
        if !self.run.is_empty() && frame < due {
            return false;
        }
        if frame > due {
            self.run.clear();
        }
        if self.run.len() == LONGEST_RUN {
            self.run.remove(0);
        }
        self.run.push(position);
        self.run_end = frame;
        self.run.len() >= WINDOW
    }

    /// Adds the stretch that ends the run. Returns the number of stretches removed for it.
    pub(crate) fn keep(&mut self) -> usize {
        let Some(stretch) = self.run.last_chunk::<WINDOW>() else {
            return 0;
        };
        let continues = self.run.len() == LONGEST_RUN;
        match self.track.pieces.last_mut() {
            Some(piece) if continues && !piece.is_full() => {
                piece.push(stretch[WINDOW - 1]);
                0
            }
            _ => {
                let is_most = self.track.pieces.len() == MOST_PIECES;
                self.track.pieces.push(Piece::new(stretch));
                if is_most {
                    self.track.forget_oldest()
                } else {
                    0
                }
            }
        }
    }
}
