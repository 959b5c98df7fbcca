//! The segments of one pedestrian, and the running track of a pedestrian that may be seen again.

use ddl_core::{Position, between};
use serde::{Deserialize, Serialize};

use crate::piece::{FirstMotion, Piece, SHARED, is_remembered};

/// A track ends after this many steps of 0.4 s (3.2 s) without a position. If the same id returns later, a new track
/// begins.
const MAX_ABSENCE_STEPS: i64 = 8;
/// Rows further apart than so many steps (1.2 s) are not joined.
const LONGEST_JOINED: i64 = 3;
/// Largest number of runs of 8 segments kept per pedestrian, the latest ones: 102 s of a pedestrian that walks about.
pub(crate) const MAX_RUNS: usize = 32;

/// A pedestrian of this memory: pieces, oldest first. Only the last may be without a segment.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(transparent)]
pub(crate) struct Track {
    pub(crate) pieces: Vec<Piece>,
}

impl Track {
    pub(crate) fn segments(&self) -> usize {
        self.pieces.iter().map(Piece::len).sum()
    }

    /// The piece with the segment nearest to a motion (the first if several are equally near), and its squared
    /// distance.
    pub(crate) fn nearest(&self, motion: &FirstMotion) -> Option<(f32, &Piece)> {
        let distances = self.pieces.iter().map(|piece| (piece.nearest(motion), piece));
        distances.reduce(|least, next| if next.0 < least.0 { next } else { least })
    }

    /// Whether a segment from its middle is similar to one of other tracks.
    pub(crate) fn is_repeated_by(&self, others: &[Self]) -> bool {
        let middle = self.pieces.get(self.pieces.len().saturating_sub(1) / 2);
        let mut others = others.iter().flat_map(|track| &track.pieces);
        let motion = middle.filter(|piece| piece.len() > 0).map(|piece| piece.motion(0));
        motion.is_some_and(|motion| others.any(|other| other.is_alike(&motion)))
    }

    /// Adds a piece. The previous last piece is removed if it repeats an earlier piece, except the one right before it.
    /// Returns the number of segments removed.
    fn add(&mut self, piece: Piece) -> usize {
        let gone = match &self.pieces[..] {
            [.., last] if last.len() == 0 => self.pieces.pop(),
            [earlier @ .., _, last] if earlier.iter().any(|old| last.is_repeated_by(old)) => self.pieces.pop(),
            pieces if pieces.len() == MAX_RUNS => Some(self.pieces.remove(0)),
            _ => None,
        };
        self.pieces.push(piece);
        gone.map_or(0, |piece| piece.len())
    }

    /// Removes the oldest piece. From an only piece it keeps the positions that the next segment needs. Returns the
    /// number of segments removed.
    pub(crate) fn forget_oldest(&mut self) -> usize {
        let Some(first) = self.pieces.first_mut() else {
            return 0;
        };
        let gone = first.len();
        *first = first.rest();
        if self.pieces.len() > 1 {
            self.pieces.remove(0);
        }
        gone
    }

    /// All its positions, in order of time.
    pub(crate) fn positions(&self) -> Vec<Position> {
        let mut positions: Vec<Position> = Vec::new();
        for piece in &self.pieces {
            let path = &piece.path;
            let shared = path.get(..SHARED);
            let follows = shared.is_some_and(|shared| positions.ends_with(shared));
            positions.extend(&path[if follows { SHARED } else { 0 }..]);
        }
        positions
    }
}

/// The track of a pedestrian seen within the last 3.2 s.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct RunningTrack {
    /// The frame of its last position.
    pub(crate) last: i64,
    pub(crate) track: Track,
    /// Its last row, if that lies between two steps.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    between: Option<(i64, Position)>,
}

impl RunningTrack {
    pub(crate) fn new(frame: i64, position: Position) -> Self {
        let pieces = vec![Piece::begin(position)];
        Self { last: frame, track: Track { pieces }, between: None }
    }

    /// The frame of its last row; `None` if that cannot be, in a file.
    pub(crate) fn last_row(&self, step: i64) -> Option<i64> {
        match self.between {
            None => Some(self.last),
            Some((frame, position)) => {
                let after = frame.checked_sub(self.last).filter(|after| (1..step).contains(after));
                after.filter(|_| is_remembered(position)).map(|_| frame)
            }
        }
    }

    /// Whether the track has ended by this frame.
    pub(crate) fn is_gone(&self, frame: i64, step: i64) -> bool {
        frame - self.last > MAX_ABSENCE_STEPS * step
    }

    /// Adds a row, and the positions at the steps between it and the row before, on a straight line.
    /// Returns the numbers of segments added and removed.
    pub(crate) fn see(&mut self, frame: i64, position: Position, step: i64) -> (usize, usize) {
        let (mut new, mut gone) = (0, 0);
        let last = self.track.pieces.last().and_then(|piece| piece.path.last());
        let last = last.map(|&last| (self.last, last));
        let before = self.between.take().or(last);
        let before = before.filter(|(before, _)| frame - before <= LONGEST_JOINED * step);
        while let Some((from, start)) = before
            && frame > self.last + step
        {
            let due = self.last + step;
            let share = (due - from) as f64 / (frame - from) as f64;
            let (added, removed) = self.add(due, between(start, position, share), step);
            (new, gone) = (new + added, gone + removed);
        }
        if frame < self.last + step {
            self.between = Some((frame, position));
            return (new, gone);
        }
        let (added, removed) = self.add(frame, position, step);
        (new + added, gone + removed)
    }

    /// Adds a row that no path joins to those before.
    pub(crate) fn begin_anew(&mut self, frame: i64, position: Position) -> (usize, usize) {
        (self.last, self.between) = (frame, None);
        (0, self.track.add(Piece::begin(position)))
    }

    fn add(&mut self, frame: i64, position: Position, step: i64) -> (usize, usize) {
        let due = self.last + step;
        self.last = frame;
        let next = match self.track.pieces.last_mut() {
            Some(piece) if frame == due => match piece.push(position) {
                None => return (usize::from(piece.len() > 0), 0),
                Some(next) => next,
            },
            _ => Piece::begin(position),
        };
        (next.len(), self.track.add(next))
    }
}
