//! A place that is watched: what is remembered of it, and whether a memory is of this place at all.

use crate::error::DdlError;
use crate::model::ddl::Ddl;
use ddl_data::{OBSERVED, PedestrianId, Position, Window};
use ddl_memory::SceneMemory;
use std::collections::BTreeSet;
use std::fmt;

/// A pedestrian has walked like another where the squared distance of the motions is below this: 2 m, for instance.
const ALIKE: f64 = 4.0;
/// Pedestrians on whom a memory is tried.
const TRIED: usize = 30;
/// A memory is refused where a smaller share than this of them walk as somebody did in the memory. Of 65 pairs of parts of
/// recordings of one camera the smallest share was 0.30, of 89 pairs of two cameras 7 in 8 are below 0.15 (docs/memory.md).
const LEAST_SHARE: f64 = 0.15;
/// With fewer pedestrians a memory is not refused: at the smallest share of one camera, 0.30, none of 12 pedestrians has a similar
/// trajectory in the memory with a probability of 1.4 %.
const FEWEST_TRIED: usize = 13;

/// A memory that is fed with what is forecast from: the part of a [`LiveForecaster`](crate::LiveForecaster) that remembers,
/// for programs that keep tracks themselves.
///
/// A memory that already holds [`OtherPlace::FEWEST_STRETCHES`] is tried on the first pedestrians. Where it is of another
/// place, it is [refused](Self::refused), and the place is remembered from then on by an empty one.
#[derive(Debug, Clone)]
pub struct WatchedPlace {
    memory: SceneMemory,
    /// Earlier pedestrians recalled for each pedestrian.
    count: usize,
    trial: Option<Trial>,
    refused: Option<OtherPlace>,
}

/// A memory that was given, as it was, until it is known to be of this place.
#[derive(Debug, Clone)]
struct Trial {
    given: SceneMemory,
    tried: BTreeSet<PedestrianId>,
    alike: usize,
}

/// A memory was given that is not of the place that is watched.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub struct OtherPlace {
    /// Pedestrians on whom it was tried.
    pub tried: usize,
    /// Of these, who walked where and as somebody did in the memory.
    pub alike: usize,
}

impl OtherPlace {
    /// A memory with fewer stretches is not tried: it may be of any place.
    pub const FEWEST_STRETCHES: usize = 500;
}

impl fmt::Display for OtherPlace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { tried, alike } = self;
        write!(
            f,
            "the memory is of another place, or the camera was moved: of {tried} pedestrians {alike} walked where and as \
             somebody did in the memory"
        )
    }
}

impl WatchedPlace {
    /// With a memory as it was made or read; tracks that were running in it have ended.
    ///
    /// # Errors
    /// When the model has no memory branch.
    pub fn new(model: &Ddl, mut memory: SceneMemory) -> Result<Self, DdlError> {
        let count = model.goal_model().remembered_at_once()?;
        memory.interrupt();
        let known = memory.stretches() >= OtherPlace::FEWEST_STRETCHES;
        let trial = known.then(|| Trial {
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

    /// What is remembered, of the memory that was given and since.
    pub fn memory(&self) -> &SceneMemory {
        &self.memory
    }

    /// Why the memory that was given is no longer used; `None` while it is.
    pub fn refused(&self) -> Option<&OtherPlace> {
        self.refused.as_ref()
    }

    /// The number of pedestrians on whom the memory that was given was tried so far, while it may still turn out to be of another
    /// place; `None` once that is decided.
    pub fn on_trial(&self) -> Option<usize> {
        self.trial.as_ref().map(|trial| trial.tried.len())
    }

    /// Ends the trial of the memory by those whom it was tried on so far, where no more are to come. Where these are too few to tell
    /// that it is of another place, and none of them walk alike, it stays [on trial](Self::on_trial).
    pub fn end_trial(&mut self) {
        if let Some(trial) = &self.trial {
            let tried = trial.tried.len();
            if trial.alike as f64 >= LEAST_SHARE * tried.max(1) as f64 {
                self.trial = None;
            } else if tried >= FEWEST_TRIED {
                self.refuse();
            }
        }
    }

    /// The tracker starts anew: all tracks end, and any frame may come next.
    pub fn interrupt(&mut self) {
        self.memory.interrupt();
    }

    /// The window with what is remembered for its pedestrians. To be asked before its last frame is
    /// [observed](Self::observe).
    #[must_use]
    pub fn recalling(&self, window: Window) -> Window {
        self.memory.recalling(window, self.count)
    }

    /// Remembers a frame, whose window, if there was one, is forecast from.
    ///
    /// # Errors
    /// As [`SceneMemory::observe`]. Nothing has changed then.
    pub fn observe(
        &mut self,
        frame: i64,
        people: impl IntoIterator<Item = (PedestrianId, Position)>,
        window: Option<&Window>,
    ) -> Result<(), DdlError> {
        self.memory.observe(frame, people)?;
        if let (Some(trial), Some(window)) = (&mut self.trial, window) {
            trial.look_at(window);
            // With so many no later pedestrian can refuse it.
            let is_certain = trial.alike as f64 >= LEAST_SHARE * TRIED as f64;
            if is_certain || trial.tried.len() >= TRIED {
                self.end_trial();
            }
        }
        Ok(())
    }

    fn refuse(&mut self) {
        if let Some(trial) = self.trial.take() {
            let (tried, alike) = (trial.tried.len(), trial.alike);
            self.refused = Some(OtherPlace { tried, alike });
            self.memory = trial.given.emptied();
        }
    }
}

impl Trial {
    /// Each pedestrian counts once, when first seen at 8 steps in a row.
    fn look_at(&mut self, window: &Window) {
        for (i, &id) in window.pedestrians().iter().enumerate() {
            let whole = window.made_up(i).is_nothing();
            if !whole || self.tried.len() >= TRIED || !self.tried.insert(id) {
                continue;
            }
            let observed: Option<&[Position; OBSERVED]> = window.observed(i).first_chunk();
            let nearest = observed.map(|observed| self.given.recall(observed, None, 1));
            let is_alike = nearest
                .and_then(|found| found.first().map(|found| found.distance < ALIKE))
                .unwrap_or(false);
            self.alike += usize::from(is_alike);
        }
    }
}
