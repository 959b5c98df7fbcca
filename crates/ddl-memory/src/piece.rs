//! A piece: up to 8 consecutive segments (20 positions each) of one track, all compared with a pedestrian at once.

use crate::error::ContentFault;
use ddl_core::{COORDINATE_LIMIT, OBSERVED, Position, TIME_STEP, WINDOW};
use serde::{Deserialize, Serialize, Serializer};

/// Segments compared at once, so that the loop over them is vectorised.
const LANES: usize = 8;
/// Positions that a piece shares with the following one: all of a segment but its last.
pub(crate) const SHARED: usize = WINDOW - 1;
/// Positions of a full piece.
const PATH: usize = LANES + SHARED;
/// Index of the present position in a segment.
const NOW: usize = OBSERVED - 1;
/// Two velocities of two components, each divided by its scale.
const VELOCITIES: usize = 4;
const COMPONENTS: usize = 2 + VELOCITIES;
/// Scales of late and early velocity (m/s): a difference of one scale adds 1 to the squared distance, as 1 m does.
const VELOCITY_SCALES: [f64; 2] = [0.4, 0.6];
/// Squared distance below which two segments are similar: that of two pedestrians that walk 1 m apart.
const ALIKE: f32 = 1.0;
/// Largest distance (m) of the present positions of a piece from the first one: an `f32` resolves micrometres within
/// it. A pedestrian usually moves 6 m in that time.
const REACH: f64 = 30.0;

/// A pedestrian's motion over 8 positions: present position (m), late and early velocity in units of their scales.
#[derive(Debug, Clone, Copy)]
pub(crate) struct FirstMotion {
    now: Position,
    velocities: [f32; VELOCITIES],
    /// How many components are compared: all, or only those of the position.
    compared: usize,
}

/// Whether a position is close enough to the origin for distances in `f32` to be finite.
pub(crate) fn is_remembered(position: Position) -> bool {
    position.iter().all(|x| x.abs() <= COORDINATE_LIMIT)
}

impl FirstMotion {
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
            compared: COMPONENTS,
        }
    }

    /// Any motion at this position.
    pub(crate) fn at(now: Position) -> Self {
        Self { now, velocities: [0.0; VELOCITIES], compared: COMPONENTS - VELOCITIES }
    }

    /// All components, with the position relative to an origin. In `f32` they are exact to micrometres near that
    /// origin.
    fn from(&self, origin: Position) -> [f32; COMPONENTS] {
        let [x, y] = [0, 1].map(|axis| (self.now[axis] - origin[axis]) as f32);
        let [u, v, early_u, early_v] = self.velocities;
        [x, y, u, v, early_u, early_v]
    }
}

/// 1 to 27 positions that are one step apart, and the motions of the up to 8 segments of 20 positions in them. A file
/// stores only the positions.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(try_from = "Vec<Position>")]
pub(crate) struct Piece {
    /// Motions of the segments relative to the present position of the first; lanes without a segment are infinite.
    motions: [[f32; LANES]; COMPONENTS],
    pub(crate) path: Vec<Position>,
}

impl Piece {
    /// The piece that holds these positions.
    fn of(path: &[Position]) -> Self {
        let mut piece = Self { motions: [[f32::INFINITY; LANES]; COMPONENTS], path: Vec::with_capacity(PATH) };
        for position in path {
            piece.add(*position);
        }
        piece
    }

    pub(crate) fn begin(position: Position) -> Self {
        Self::of(&[position])
    }

    fn add(&mut self, position: Position) {
        self.path.push(position);
        let Some(lane) = self.len().checked_sub(1) else {
            return;
        };
        let components = self.motion(lane).from(self.path[NOW]);
        for (lanes, component) in self.motions.iter_mut().zip(components) {
            lanes[lane] = component;
        }
    }

    /// Adds the next position. If this piece is full or too far away, returns the piece that begins with it instead.
    pub(crate) fn push(&mut self, position: Position) -> Option<Self> {
        if self.path.len() >= SHARED {
            let lane = self.len();
            let way = |axis| self.path[lane + NOW][axis] - self.path[NOW][axis];
            if lane == LANES || f64::hypot(way(0), way(1)) > REACH {
                let mut next = self.rest();
                next.add(position);
                return Some(next);
            }
        }
        self.add(position);
        None
    }

    /// The beginning of the next piece: the last 19 positions, one fewer than a segment has.
    pub(crate) fn rest(&self) -> Self {
        Self::of(&self.path[self.path.len().saturating_sub(SHARED)..])
    }

    /// Number of segments.
    pub(crate) fn len(&self) -> usize {
        self.path.len().saturating_sub(SHARED)
    }

    /// The 20 positions of the segment of a lane.
    pub(crate) fn segment(&self, lane: usize) -> [Position; WINDOW] {
        std::array::from_fn(|t| self.path[lane + t])
    }

    /// The motion of the segment of a lane.
    pub(crate) fn motion(&self, lane: usize) -> FirstMotion {
        FirstMotion::of(&std::array::from_fn(|t| self.path[lane + t]))
    }

    /// Whether one of its segments lies within [`ALIKE`] of a motion.
    pub(crate) fn is_alike(&self, motion: &FirstMotion) -> bool {
        self.nearest(motion) < ALIKE
    }

    /// Whether both its first and its last segment are similar to segments of another piece. This piece must have a
    /// segment.
    pub(crate) fn is_repeated_by(&self, other: &Self) -> bool {
        other.is_alike(&self.motion(0)) && other.is_alike(&self.motion(self.len() - 1))
    }

    /// Squared distance of each segment from a motion; infinite or NaN for lanes without a segment.
    #[inline]
    fn distances(&self, motion: &FirstMotion) -> [f32; LANES] {
        let origin = self.path.get(NOW).copied().unwrap_or_default();
        let wanted = motion.from(origin);
        let mut distances = [0.0; LANES];
        for (wanted, lanes) in wanted.into_iter().zip(&self.motions).take(motion.compared) {
            for lane in 0..LANES {
                let difference = wanted - lanes[lane];
                distances[lane] += difference * difference;
            }
        }
        distances
    }

    /// The smallest of the distances.
    #[inline]
    pub(crate) fn nearest(&self, motion: &FirstMotion) -> f32 {
        let mut least = self.distances(motion);
        // Halves are compared, so that the minimum takes a few vector instructions.
        for half in [4, 2, 1] {
            for lane in 0..half {
                let other = least[lane + half];
                least[lane] = if other < least[lane] { other } else { least[lane] };
            }
        }
        least[0]
    }

    /// The first of the segments nearest to a motion.
    pub(crate) fn nearest_lane(&self, motion: &FirstMotion) -> usize {
        let distances = self.distances(motion);
        let lanes = 0..self.len();
        lanes.min_by(|&a, &b| distances[a].total_cmp(&distances[b])).unwrap_or(0)
    }
}

impl Serialize for Piece {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.path.serialize(serializer)
    }
}

impl TryFrom<Vec<Position>> for Piece {
    type Error = ContentFault;

    fn try_from(path: Vec<Position>) -> Result<Self, ContentFault> {
        if !(1..=PATH).contains(&path.len()) {
            return Err(ContentFault::Run { found: path.len(), most: PATH });
        }
        match path.iter().find(|position| !is_remembered(**position)) {
            Some(position) => Err(ContentFault::Far(*position)),
            None => Ok(Self::of(&path)),
        }
    }
}
