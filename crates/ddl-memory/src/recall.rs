//! Earlier pedestrians that moved as one does now.

use ddl_data::{OBSERVED, PedestrianId, Position, Remembered};

use crate::SceneMemory;
use crate::piece::{Motion, Piece};

/// Stretches at this squared distance or farther do not count.
pub const FARTHEST: f64 = 60.0;

impl SceneMemory {
    /// What at most `count` other pedestrians did who moved as this one does, the nearest first, of each the nearest
    /// stretch: its 20 positions (m, in the world), and its squared distance.
    ///
    /// The last of the 8 observed positions (m, a step of 0.4 s apart) is now. The squared distance of a stretch is
    /// `|dp|² / (1 m)² + |dv|² / (0.4 m/s)² + |de|² / (0.6 m/s)²`, with `dp` the difference of the eighth positions,
    /// `dv` that of the velocities over the last 3 steps of the 8, and `de` over the first 3. It is computed in `f32`,
    /// to about 1e-5, and must lie below [`FARTHEST`]. Where two pedestrians are equally
    /// near, those who have left come before those who are there: who left earlier first, then by id.
    ///
    /// `own` is the id of this pedestrian, whose running track is left out. If a component of the
    /// motion is not finite, nothing is recalled.
    #[must_use]
    pub fn recall(
        &self,
        observed: &[Position; OBSERVED],
        own: Option<PedestrianId>,
        count: usize,
    ) -> Vec<Remembered> {
        let motion = Motion::of(observed);
        let running = self.running.iter().filter(|(id, _)| Some(**id) != own);
        let running = running.map(|(_, running)| &running.track);
        let mut near: Vec<(f32, usize, &Piece)> = Vec::new();
        for (age, track) in self.ended.iter().chain(running).enumerate() {
            match track.nearest(&motion) {
                Some((distance, piece)) if distance < FARTHEST as f32 => {
                    near.push((distance, age, piece));
                }
                _ => (),
            }
        }
        let by_distance = |a: &(f32, usize, &Piece), b: &(f32, usize, &Piece)| {
            a.0.total_cmp(&b.0).then(a.1.cmp(&b.1))
        };
        if count < near.len() {
            near.select_nth_unstable_by(count, by_distance);
            near.truncate(count);
        }
        near.sort_unstable_by(by_distance);
        let remembered = |(distance, _, piece): (f32, usize, &Piece)| Remembered {
            track: piece.stretch(piece.nearest_lane(&motion)),
            distance: f64::from(distance),
        };
        near.into_iter().map(remembered).collect()
    }
}
