//! Recall of earlier pedestrians with a similar motion.

use ddl_core::{OBSERVED, PedestrianId, Position, RememberedTrack};

use crate::memory::SceneMemory;
use crate::piece::{FirstMotion, Piece};

/// Squared distance from which segments are ignored.
const MAX_SQUARED_DISTANCE: f32 = 60.0;

impl SceneMemory {
    /// Returns the tracks of at most `count` other pedestrians with a similar motion, nearest first. Each is
    /// represented by its nearest segment: 20 positions (m, world coordinates) and the squared distance.
    ///
    /// The last of the 8 observed positions (m, one step of 0.4 s apart) is the present one. The squared distance of a
    /// segment is `|dp|² / (1 m)² + |dv|² / (0.4 m/s)² + |de|² / (0.6 m/s)²`. Here `dp` is the difference of the eighth
    /// positions, `dv` that of the velocities over the last 3 of the 8 steps, and `de` that over the first 3. It is
    /// computed in `f32`, to about 1e-5, and must be below 60. Pedestrians at equal distance are
    /// ordered: first those that have left, in the order in which they left, then those present, by id.
    ///
    /// `own` is the id of this pedestrian, whose running track is left out. If a component of the motion is not finite,
    /// the result is empty.
    #[must_use]
    pub fn recall(
        &self,
        observed: &[Position; OBSERVED],
        own: Option<PedestrianId>,
        count: usize,
    ) -> Vec<RememberedTrack> {
        self.recall_motion(&FirstMotion::of(observed), own, count)
    }

    /// As [`recall`](Self::recall), of a pedestrian at this position whose motion is not known: the squared distance is
    /// `|dp|² / (1 m)²`.
    #[must_use]
    pub fn recall_at(&self, position: Position, own: Option<PedestrianId>, count: usize) -> Vec<RememberedTrack> {
        self.recall_motion(&FirstMotion::at(position), own, count)
    }

    fn recall_motion(&self, motion: &FirstMotion, own: Option<PedestrianId>, count: usize) -> Vec<RememberedTrack> {
        let running = self.running.iter().filter(|(id, _)| Some(**id) != own);
        let running = running.map(|(_, running)| &running.track);
        let mut near: Vec<(f32, usize, &Piece)> = Vec::new();
        for (age, track) in self.ended.iter().chain(running).enumerate() {
            match track.nearest(motion) {
                Some((distance, piece)) if distance < MAX_SQUARED_DISTANCE => {
                    near.push((distance, age, piece));
                }
                _ => (),
            }
        }
        let by_distance = |a: &(f32, usize, &Piece), b: &(f32, usize, &Piece)| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1));
        if count < near.len() {
            near.select_nth_unstable_by(count, by_distance);
            near.truncate(count);
        }
        near.sort_unstable_by(by_distance);
        let remembered = |(distance, _, piece): (f32, usize, &Piece)| RememberedTrack {
            track: piece.segment(piece.nearest_lane(motion)),
            distance: f64::from(distance),
        };
        near.into_iter().map(remembered).collect()
    }
}
