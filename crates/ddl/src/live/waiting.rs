//! The windows that wait for an answer.

use crate::error::DdlError;
use crate::forecast::answer::Answer;
use crate::tracks::moment::Moment;
use ddl_core::Window;
use ddl_data::{Clock, SceneName};
use std::collections::{BTreeMap, VecDeque};

/// A queue of the windows of many scenes, the oldest first.
#[derive(Debug, Clone, Default)]
pub struct WaitingWindows {
    windows: VecDeque<(Option<SceneName>, Window)>,
    pub(crate) is_latest_only: bool,
    dropped: u64,
    dropped_of: BTreeMap<Option<SceneName>, u64>,
}

/// Windows that are answered in one call.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SceneBatch {
    /// The scene of each window; `None` for a stream without scene names.
    pub scenes: Vec<Option<SceneName>>,
    /// The windows, in the order of `scenes`.
    pub windows: Vec<Window>,
}

impl SceneBatch {
    /// The windows with their scenes.
    pub fn windows(&self) -> SceneWindows<'_> {
        SceneWindows { windows: &self.windows, scenes: &self.scenes }
    }

    /// Number of pedestrians in a batch with a short latency: several cameras with a dozen pedestrians each, or one
    /// crowd.
    pub const PEDESTRIANS: usize = 50;

    /// Each window as a batch of its own.
    pub fn each(self) -> impl Iterator<Item = Self> {
        let pairs = self.scenes.into_iter().zip(self.windows);
        pairs.map(|(scene, window)| Self { scenes: vec![scene], windows: vec![window] })
    }
}

/// Windows in order of time, of a file or of a batch.
#[derive(Debug, Clone, Copy)]
pub struct SceneWindows<'a> {
    /// The windows.
    pub windows: &'a [Window],
    /// The scene of each; empty if the tracks name no scenes.
    pub scenes: &'a [Option<SceneName>],
}

impl<'a> SceneWindows<'a> {
    /// The scene of window `i`.
    pub fn scene(&self, i: usize) -> Option<&'a SceneName> {
        self.scenes.get(i)?.as_ref()
    }

    /// The moments of the windows, with the answer to each.
    pub fn moments(self, answers: &'a [Answer], clock: Clock) -> Vec<Moment<'a>> {
        let pairs = self.windows.iter().zip(answers).enumerate();
        let moments =
            pairs.map(|(i, (window, answer))| Moment { scene: self.scene(i), ..Moment::new(window, answer, clock) });
        moments.collect()
    }
}

impl WaitingWindows {
    /// Largest number of waiting windows.
    pub(crate) const MOST: usize = 10_000;

    pub(crate) fn ensure_room(&self) -> Result<(), DdlError> {
        if self.windows.len() < Self::MOST { Ok(()) } else { Err(DdlError::TooManyWaiting { limit: Self::MOST }) }
    }

    /// Adds the window of a frame, if it has one. A frame between two moments replaces nothing.
    pub(crate) fn add(&mut self, name: Option<SceneName>, window: Option<Window>, is_due: bool) {
        let older = self.windows.iter().position(|(scene, _)| self.is_latest_only && *scene == name);
        match (older, window) {
            (Some(_), None) if !is_due => {}
            (Some(index), window) => {
                self.dropped += 1;
                *self.dropped_of.entry(name).or_default() += 1;
                match window {
                    Some(window) => self.windows[index].1 = window,
                    None => drop(self.windows.remove(index)),
                }
            }
            (None, Some(window)) => self.windows.push_back((name, window)),
            (None, None) => {}
        }
    }

    pub(crate) fn take(&mut self, pedestrians: usize) -> SceneBatch {
        let mut batch = SceneBatch::default();
        let mut taken = 0;
        while let Some((_, window)) = self.windows.front() {
            taken += window.len();
            if taken > pedestrians && !batch.windows.is_empty() {
                break;
            }
            if let Some((scene, window)) = self.windows.pop_front() {
                batch.scenes.push(scene);
                batch.windows.push(window);
            }
        }
        batch
    }

    /// Forgets what was counted of a scene; its windows stay.
    pub(crate) fn forget(&mut self, scene: Option<&SceneName>) {
        self.dropped_of.remove(&scene.cloned());
    }

    /// Number of windows that wait.
    pub fn count(&self) -> usize {
        self.windows.len()
    }

    /// Number of windows that were not answered, because a window of a later frame replaced them.
    pub fn dropped(&self) -> u64 {
        self.dropped
    }

    /// The known scene with the most [dropped](Self::dropped) windows, and their number.
    pub fn most_dropped(&self) -> Option<(&SceneName, u64)> {
        let named = self.dropped_of.iter().filter_map(|(name, dropped)| Some((name.as_ref()?, *dropped)));
        named.max_by_key(|(_, dropped)| *dropped)
    }
}
