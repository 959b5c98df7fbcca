//! Earlier pedestrians that moved as one does now.

use ddl_data::{OBSERVED, PedestrianId, Position, WINDOW};

use crate::SceneMemory;
use crate::piece::Motion;
use crate::track::Track;

/// Stretches at this squared distance or farther do not count.
pub const FARTHEST: f64 = 60.0;

/// What a memory knows about a pedestrian's motion.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Recalled {
    /// Stretches of as many pedestrians, the nearest first.
    pub examples: Vec<Example>,
    /// Sum of `exp(-d / 2)` over all pedestrians of the memory, `d` the squared distance of their nearest stretch:
    /// about how many moved like this.
    pub support: f64,
}

/// What another pedestrian did.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Example {
    /// 20 positions in metres in the world, 0.4 s apart: 8 like those observed, and the 12 that followed.
    pub track: [Position; WINDOW],
    /// The squared distance of its first 8 positions from those observed.
    pub distance: f64,
}

impl SceneMemory {
    /// What at most `count` other pedestrians did who moved as this one does, the nearest first, of each the nearest
    /// stretch.
    ///
    /// The last of the observed positions (m, a step of 0.4 s apart) is now. The squared distance of a stretch is
    /// `|dp|² / (1 m)² + |dv|² / (0.4 m/s)² + |de|² / (0.6 m/s)²`, with `dp` the difference of the eighth positions,
    /// `dv` that of the velocities over the last 3 steps of the 8, and `de` over the first 3. It is computed in `f32`,
    /// to about 1e-5, and must lie below [`FARTHEST`]. Ties go by age, then by id, then to the earlier stretch.
    ///
    /// `own` is the id of this pedestrian, whose running track is left out. If a component of the
    /// motion is not finite, nothing is recalled.
    #[must_use]
    pub fn recall(
        &self,
        observed: &[Position; OBSERVED],
        own: Option<PedestrianId>,
        count: usize,
    ) -> Recalled {
        let motion = Motion::of(observed);
        let mut support = 0.0;
        let mut near: Vec<(f32, &Track)> = Vec::new();
        let running = self.running.iter().filter(|(id, _)| Some(**id) != own);
        let running = running.map(|(_, running)| &running.track);
        for track in self.ended.iter().chain(running) {
            let distance = track.nearest(&motion);
            if distance < FARTHEST as f32 {
                support += (-0.5 * f64::from(distance)).exp();
                near.push((distance, track));
            }
        }
        let by_distance = |a: &(f32, &Track), b: &(f32, &Track)| {
            a.0.total_cmp(&b.0).then(a.1.number.cmp(&b.1.number))
        };
        if count < near.len() {
            near.select_nth_unstable_by(count, by_distance);
            near.truncate(count);
        }
        near.sort_unstable_by(by_distance);
        let example = |(distance, track): (f32, &Track)| {
            Some(Example {
                track: track.stretch_at(&motion, distance)?,
                distance: f64::from(distance),
            })
        };
        let examples = near.into_iter().filter_map(example).collect();
        Recalled { examples, support }
    }
}
