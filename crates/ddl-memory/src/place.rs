//! The memory of a place, and the test whether a given memory is of this place.

use std::collections::BTreeSet;

use ddl_core::{OBSERVED, PedestrianId, Position, Window};

use crate::error::MemoryError;
use crate::memory::SceneMemory;

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
    refused: Option<Refusal>,
}

/// Why a given memory is no longer used: it is of another place.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error(
    "the memory is of another place, or the camera was moved: only {alike} of {tried} pedestrians moved like an \
     earlier pedestrian in the memory"
)]
pub struct Refusal {
    /// Number of pedestrians that it was tested on.
    pub tried: usize,
    /// Those of them who moved like an earlier one.
    pub alike: usize,
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
    /// Starts with an empty memory or one from a file; tracks that were running in it have ended. `count` earlier
    /// pedestrians are recalled for each pedestrian.
    #[must_use]
    pub fn new(mut memory: SceneMemory, count: usize) -> Self {
        memory.end_tracks();
        let is_tested = memory.segments() >= MIN_SEGMENTS;
        let trial = is_tested.then(|| Trial { given: memory.clone(), tried: BTreeSet::new(), alike: 0 });
        Self { memory, count, trial, refused: None }
    }

    /// The memory: the given one, with the frames observed since.
    pub fn memory(&self) -> &SceneMemory {
        &self.memory
    }

    /// The reason why the given memory is no longer used; `None` while it is.
    pub fn refused(&self) -> Option<Refusal> {
        self.refused
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
    pub fn end_tracks(&mut self) {
        self.memory.end_tracks();
    }

    /// The window with the memory for its pedestrians. Call it before its last frame is [observed](Self::observe).
    #[must_use]
    pub fn recalling(&self, window: Window) -> Window {
        self.memory.recalling(window, self.count)
    }

    /// Observes a frame, in which the tracks of `begun` begin anew, and tests the memory on its window, if there is
    /// one.
    ///
    /// # Errors
    /// As [`SceneMemory::observe`]. The state is then unchanged.
    pub fn observe(
        &mut self,
        frame: i64,
        pedestrians: impl IntoIterator<Item = (PedestrianId, Position)>,
        begun: &[PedestrianId],
        window: Option<&Window>,
    ) -> Result<(), MemoryError> {
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
            self.refused = Some(Refusal { tried: trial.tried.len(), alike: trial.alike });
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
pub(crate) mod tests {
    use ddl_core::ObservationQuality;

    use super::*;

    fn position(t: i64, lane: f64) -> Position {
        [0.5 * t as f64, 0.2 * t as f64 + lane]
    }

    /// 55 pedestrians on one lane, one after another, with 10 segments each; three frames make a step.
    pub(crate) fn memory(pedestrians: i64) -> SceneMemory {
        let mut memory = SceneMemory::new(3, 9_000).unwrap();
        for t in 0..29 * pedestrians {
            memory.observe(3 * t, [(PedestrianId(t / 29), position(t % 29, 0.0))]).unwrap();
        }
        memory
    }

    /// The memory of a place after so many pedestrians on each lane, so far (m) from that of the memory.
    pub(crate) fn seen_after(memory: SceneMemory, lanes: &[(i64, f64)]) -> PlaceMemory {
        let mut place = PlaceMemory::new(memory, 20);
        let lanes = lanes.iter().flat_map(|&(count, lane)| vec![lane; count as usize]);
        for (id, lane) in (0..).zip(lanes) {
            let window_on = |lane: f64| {
                let (ids, track) = (vec![PedestrianId(id)], (0..8).map(|t| position(t, lane)).collect());
                Window::new("live", 99 * id, 3, ids, vec![track]).unwrap()
            };
            let window = window_on(lane);
            let unseen = ObservationQuality { unseen: 1, ..ObservationQuality::default() };
            // Counted once, and not before it was seen for 8 steps: until then it seems to be elsewhere.
            let partial = window_on(if lane.abs() < 2.0 { 9.0 } else { 0.0 }).with_qualities(vec![unseen]);
            for (later, window) in [(0, None), (1, Some(&partial)), (2, Some(&window)), (3, Some(&window))] {
                let row = [(PedestrianId(id), position(7, lane))];
                place.observe(99 * id + later, row, &[], window).unwrap();
            }
        }
        place
    }

    /// Tracks less than 2 m apart are alike. 5 of 30 pedestrians are more than 15 %, 4 are not; fewer than 13 refuse
    /// nothing.
    #[test]
    fn a_memory_is_refused_and_accepted_by_the_share_of_pedestrians_alike() {
        let given = memory(55);
        assert_eq!(given.segments(), 550);
        let other = |alike, tried| Some(Refusal { tried, alike });
        for (lanes, finished, tested, refused) in [
            (&[(30, 2.3)][..], false, None, other(0, 30)),
            (&[(26, -2.3), (4, 1.95)], false, None, other(4, 30)),
            (&[(25, 2.3), (4, -1.95)], false, Some(29), None),
            (&[(25, 2.3), (5, -1.95)], false, None, None),
            (&[(4, 1.95)], false, Some(4), None),
            (&[(5, 1.95)], false, None, None),
            (&[(12, 2.3)], true, Some(12), None),
            (&[(13, 2.3)], true, None, other(0, 13)),
            (&[(6, 2.3), (1, 1.95)], true, Some(7), None),
            (&[(5, 2.3), (1, 1.95)], true, None, None),
        ] {
            let mut place = seen_after(given.clone(), lanes);
            if finished {
                place.finish_test();
            }
            assert_eq!(place.under_test(), tested, "{lanes:?}");
            assert_eq!(place.refused(), refused, "{lanes:?}");
            // Who was seen is remembered, unless the memory is of another place: then it begins anew.
            let (seen, summary) = (lanes.iter().map(|lane| lane.0).sum::<i64>() as u64, place.memory().summary());
            let expected = if refused.is_some() { (0, u64::from(!finished)) } else { (550, 55 + seen) };
            assert_eq!((summary.segments, summary.pedestrians), expected, "{lanes:?}");
            assert_eq!(place.memory().empty_copy(), given.empty_copy());
        }
        // Too few segments to be tested.
        assert_eq!(seen_after(memory(49), &[]).under_test(), None);
        assert_eq!(seen_after(memory(50), &[]).under_test(), Some(0));
    }
}
