//! Consecutive stretches of one track, compared with a pedestrian all at once.

use ddl_data::{OBSERVED, Position, TIME_STEP, WINDOW};

/// Stretches compared at once: the loop over them becomes vector instructions.
pub(crate) const LANES: usize = 8;
/// Positions of a full piece.
const PATH: usize = LANES + WINDOW - 1;
/// Index of the present position in a stretch.
pub(crate) const NOW: usize = OBSERVED - 1;
/// Two velocities of two components, each divided by its scale.
const VELOCITIES: usize = 4;
const COMPONENTS: usize = 2 + VELOCITIES;
/// Scales of late and early velocity (m/s): a difference of one scale adds 1 to the squared distance, as 1 m does.
const VELOCITY_SCALES: [f64; 2] = [0.4, 0.6];

/// A pedestrian's motion over 8 positions: where now (m), late and early velocity in units of their scales.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Motion {
    pub(crate) now: Position,
    pub(crate) velocities: [f32; VELOCITIES],
}

impl Motion {
    pub(crate) fn of(observed: &[Position; OBSERVED]) -> Self {
        let velocity = |from: usize, scale: f64, axis: usize| {
            let way = observed[from + 3][axis] - observed[from][axis];
            (way / (3.0 * TIME_STEP * scale)) as f32
        };
        let [late, early] = VELOCITY_SCALES;
        Self {
            now: observed[NOW],
            velocities: [
                velocity(NOW - 3, late, 0),
                velocity(NOW - 3, late, 1),
                velocity(0, early, 0),
                velocity(0, early, 1),
            ],
        }
    }

    /// All components, the place relative to an origin: in `f32` it is exact to micrometres near the origin, wherever
    /// that is.
    fn from(&self, origin: Position) -> [f32; COMPONENTS] {
        let [x, y] = [0, 1].map(|axis| (self.now[axis] - origin[axis]) as f32);
        let [u, v, early_u, early_v] = self.velocities;
        [x, y, u, v, early_u, early_v]
    }
}

/// Up to [`LANES`] stretches, each a step after the one before.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Piece {
    /// Motions relative to the present position of the first stretch.
    motions: [[f32; LANES]; COMPONENTS],
    len: usize,
    path: [Position; PATH],
}

impl Piece {
    /// The stretches of 20 to 27 positions.
    pub(crate) fn of(path: &[Position]) -> Option<Self> {
        let (first, rest) = path.split_first_chunk()?;
        let mut piece = Self::new(first);
        for position in rest {
            if piece.is_full() {
                return None;
            }
            piece.push(*position);
        }
        Some(piece)
    }

    pub(crate) fn new(stretch: &[Position; WINDOW]) -> Self {
        let mut piece = Self {
            // Unused lanes are infinite and never nearest.
            motions: [[f32::INFINITY; LANES]; COMPONENTS],
            len: 0,
            path: [[0.0; 2]; PATH],
        };
        piece.path[..WINDOW].copy_from_slice(stretch);
        piece.index();
        piece
    }

    /// The stretch that ends a step later. The piece must not be full.
    pub(crate) fn push(&mut self, position: Position) {
        self.path[self.len + WINDOW - 1] = position;
        self.index();
    }

    /// Adds the motion of the stretch after the last.
    fn index(&mut self) {
        let lane = self.len;
        let components = self.motion_of(lane).from(self.path[NOW]);
        for (lanes, component) in self.motions.iter_mut().zip(components) {
            lanes[lane] = component;
        }
        self.len += 1;
    }

    pub(crate) fn len(&self) -> usize {
        self.len
    }

    pub(crate) fn is_full(&self) -> bool {
        self.len == LANES
    }

    /// The positions of all its stretches: 19, and one for each.
    pub(crate) fn path(&self) -> &[Position] {
        &self.path[..self.len + WINDOW - 1]
    }

    /// 20 positions of the stretch of a lane.
    pub(crate) fn stretch(&self, lane: usize) -> [Position; WINDOW] {
        std::array::from_fn(|t| self.path[lane + t])
    }

    /// The motion at the start of its first stretch.
    pub(crate) fn motion(&self) -> Motion {
        self.motion_of(0)
    }

    fn motion_of(&self, lane: usize) -> Motion {
        Motion::of(&std::array::from_fn(|t| self.path[lane + t]))
    }

    /// Squared distance of each stretch from a motion, infinite where there is none.
    #[inline]
    pub(crate) fn distances(&self, motion: &Motion) -> [f32; LANES] {
        let wanted = motion.from(self.path[NOW]);
        let mut distances = [0.0; LANES];
        for (wanted, lanes) in wanted.into_iter().zip(&self.motions) {
            for lane in 0..LANES {
                let difference = wanted - lanes[lane];
                distances[lane] += difference * difference;
            }
        }
        distances
    }

    /// The least of the distances.
    #[inline]
    pub(crate) fn nearest(&self, motion: &Motion) -> f32 {
        let mut least = self.distances(motion);
        // Halves: the minimum of all is a few vector instructions.
        for half in [4, 2, 1] {
            for lane in 0..half {
                let other = least[lane + half];
                least[lane] = if other < least[lane] {
                    other
                } else {
                    least[lane]
                };
            }
        }
        least[0]
    }
}
