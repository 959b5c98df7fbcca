//! The memory of a place, and the test whether a given memory is of this place.

use crate::error::DdlError;
use crate::model::ddl::Ddl;
use ddl_data::{OBSERVED, PedestrianId, Position, Window};
use ddl_memory::SceneMemory;
use std::collections::BTreeSet;

/// Two motions are similar if their squared distance is below this, which corresponds to 2 m.
const ALIKE: f64 = 4.0;
/// Number of pedestrians that a memory is tested on.
const TRIED: usize = 30;
/// A memory is refused if a smaller share of these pedestrians moves like an earlier pedestrian in the memory. For 65
/// pairs of recordings of one camera, the smallest share was 0.30. For 89 pairs of two cameras, 7 in 8 shares are below
/// 0.15 (docs/memory.md).
const LEAST_SHARE: f64 = 0.15;
/// A memory is not refused on fewer pedestrians. At a share of 0.30, the smallest of one camera, 12 pedestrians all
/// lack a similar track with a probability of 1.4 %.
const FEWEST_TRIED: usize = 13;

/// The memory of an observed place, and the test that the memory belongs to it.
///
/// A memory of at least 500 segments is tested on the first pedestrians. If it is of another place, it is
/// [refused](Self::refused), and an empty one replaces it.
#[derive(Debug, Clone)]
pub struct PlaceMemory {
    memory: SceneMemory,
    /// Earlier pedestrians recalled for each pedestrian.
    count: usize,
    trial: Option<Trial>,
    /// Why the given memory is no longer used.
    refused: Option<String>,
}

/// The given memory, unchanged, until it is confirmed to be of this place.
#[derive(Debug, Clone)]
struct Trial {
    given: SceneMemory,
    tried: BTreeSet<PedestrianId>,
    alike: usize,
}

/// A memory with fewer segments is not tested: it may be of any place.
const MIN_SEGMENTS: usize = 500;

impl PlaceMemory {
    /// Starts with an empty memory or one from a file; tracks that were running in it have ended.
    ///
    /// # Errors
    /// When the model has no memory branch.
    pub(crate) fn new(model: &Ddl, mut memory: SceneMemory) -> Result<Self, DdlError> {
        let count = model.goal_model().recalled_per_pedestrian()?;
        memory.end_tracks();
        let is_tested = memory.segments() >= MIN_SEGMENTS;
        let trial = is_tested.then(|| Trial {
            given: memory.clone(),
            tried: BTreeSet::new(),
            alike: 0,
        });
        Ok(Self {
            memory,
            count,
            trial,
            refused: None,
        })
    }

    /// The memory: the given one, with the frames observed since.
    pub fn memory(&self) -> &SceneMemory {
        &self.memory
    }

    /// The reason why the given memory is no longer used; `None` while it is.
    pub fn refused(&self) -> Option<&str> {
        self.refused.as_deref()
    }

    /// The number of pedestrians that the given memory was tested on so far; `None` once the test is decided.
    pub(crate) fn under_test(&self) -> Option<usize> {
        self.trial.as_ref().map(|trial| trial.tried.len())
    }

    /// Ends the test of the memory; call it when no more pedestrians will follow. If there were too few to refuse the
    /// memory, and none of them moved like an earlier one, the test stays [undecided](Self::under_test).
    pub(crate) fn finish_test(&mut self) {
        if let Some(trial) = &self.trial {
            let tried = trial.tried.len();
            if trial.alike as f64 >= LEAST_SHARE * tried.max(1) as f64 {
                self.trial = None;
            } else if tried >= FEWEST_TRIED {
                self.refuse();
            }
        }
    }

    /// Ends all tracks, as when a tracker restarts: any frame may follow.
    pub(crate) fn end_tracks(&mut self) {
        self.memory.end_tracks();
    }

    /// The window with the memory for its pedestrians. Call it before its last frame is [observed](Self::observe).
    #[must_use]
    pub(crate) fn recalling(&self, window: Window) -> Window {
        self.memory.recalling(window, self.count)
    }

    /// Observes a frame, in which the tracks of `begun` begin anew, and tests the memory on its window, if there is
    /// one.
    ///
    /// # Errors
    /// As [`SceneMemory::observe`]. The state is then unchanged.
    pub(crate) fn observe(
        &mut self,
        frame: i64,
        pedestrians: impl IntoIterator<Item = (PedestrianId, Position)>,
        begun: &[PedestrianId],
        window: Option<&Window>,
    ) -> Result<(), DdlError> {
        self.memory.observe_begun(frame, pedestrians, begun)?;
        if let (Some(trial), Some(window)) = (&mut self.trial, window) {
            trial.look_at(window);
            // With this many similar pedestrians, later ones cannot cause a refusal.
            let is_certain = trial.alike as f64 >= LEAST_SHARE * TRIED as f64;
            if is_certain || trial.tried.len() >= TRIED {
                self.finish_test();
            }
        }
        Ok(())
    }

    fn refuse(&mut self) {
        if let Some(trial) = self.trial.take() {
            let (tried, alike) = (trial.tried.len(), trial.alike);
            self.refused = Some(format!(
                "the memory is of another place, or the camera was moved: only {alike} of {tried} pedestrians moved \
                 like an earlier pedestrian in the memory"
            ));
            self.memory = trial.given.empty_copy();
        }
    }
}

impl Trial {
    /// Each pedestrian counts once, when first observed at 8 consecutive time steps.
    fn look_at(&mut self, window: &Window) {
        for (i, &id) in window.pedestrians().iter().enumerate() {
            if !window.quality(i).is_whole() || self.tried.len() >= TRIED || !self.tried.insert(id) {
                continue;
            }
            let observed: Option<&[Position; OBSERVED]> = window.observed(i).first_chunk();
            let nearest = observed.map(|observed| self.given.recall(observed, None, 1));
            let is_alike = nearest
                .and_then(|recalled| recalled.first().map(|recalled| recalled.distance < ALIKE))
                .unwrap_or(false);
            self.alike += usize::from(is_alike);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::builtin_model::BuiltinModel;
    use ddl_data::{Dataset, LiveTracks};
    use ddl_network::DeviceChoice;

    /// A few pedestrians without similar trajectories do not show that the memory belongs to another place.
    #[test]
    fn few_pedestrians_do_not_refuse_a_memory_and_some_alike_accept_it_early() {
        let model = Ddl::builtin(BuiltinModel::default(), DeviceChoice::Cpu).unwrap();
        let dataset = Dataset::simulated(1);
        let corridor = dataset.recording("corridor").unwrap();
        let seen = |frame: i64, by: f64| -> Vec<(PedestrianId, Position)> {
            let here = corridor.at(frame).iter();
            here.map(|seen| (seen.pedestrian, seen.position.map(|x| x + by)))
                .collect()
        };
        let mut memory = SceneMemory::new(corridor.frame_step(), SceneMemory::DEFAULT_CAPACITY).unwrap();
        for &frame in &corridor.frames()[..300] {
            memory.observe(frame, seen(frame, 0.0)).unwrap();
        }
        let tried = |by: f64, steps: usize| {
            let mut place = PlaceMemory::new(&model, memory.clone()).unwrap();
            let mut tracks = LiveTracks::with_frame_step(corridor.frame_step()).unwrap();
            for &frame in &corridor.frames()[..steps] {
                tracks = tracks.after(frame, seen(frame, by)).unwrap();
                place
                    .observe(frame, seen(frame, by), &[], tracks.window().as_ref())
                    .unwrap();
            }
            place
        };
        let mut elsewhere = tried(500.0, 9);
        let few = elsewhere.under_test().unwrap();
        assert!((1..13).contains(&few), "{few}");
        elsewhere.finish_test();
        assert_eq!(elsewhere.under_test(), Some(few));
        assert_eq!(elsewhere.refused(), None);
        // In its own place it is accepted before 30 pedestrians were seen.
        let accepted = (9..120).find(|&steps| tried(0.0, steps).under_test().is_none());
        let seen = tried(500.0, accepted.unwrap()).under_test();
        assert!(seen.is_some_and(|seen| (5..30).contains(&seen)), "{seen:?}");
    }
}
