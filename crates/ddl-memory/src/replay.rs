//! Replay of a recording: its windows, each with the tracks that the memory recalls at that time.

use ddl_core::{OBSERVED, Window};
use ddl_data::Recording;

use crate::error::MemoryError;
use crate::memory::SceneMemory;

/// The order in which the frames of a recording are observed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Playback {
    /// In recorded order.
    Forward,
    /// From the last to the first, for windows that are [reversed](Window::reversed).
    Backward,
}

impl Playback {
    fn time(self, frame: i64) -> i64 {
        match self {
            Self::Forward => frame,
            Self::Backward => -frame,
        }
    }

    /// The frame from which the forecast starts.
    fn now(self, window: &Window) -> i64 {
        match self {
            Self::Forward => window.frames()[OBSERVED - 1],
            // A reversed window has the same frames as the window.
            Self::Backward => -window.frames()[window.steps() - OBSERVED],
        }
    }
}

impl SceneMemory {
    /// The windows of one recording, each with at most `count` remembered tracks per pedestrian. Before each window,
    /// this memory observes the recording up to the last observed frame of the window, and no later frame.
    ///
    /// With [`Playback::Backward`], observation begins at the last frame of the windows.
    ///
    /// # Errors
    /// [`MemoryError`] if the number of raw frames per step differs between recording and memory.
    pub fn replay(
        mut self,
        recording: &Recording,
        playback: Playback,
        windows: Vec<Window>,
        count: usize,
    ) -> Result<Vec<Window>, MemoryError> {
        self.ensure_step_of(recording)?;
        self.end_tracks();
        let last = windows.iter().map(|window: &Window| window.frames()[window.steps() - 1]).max();
        let mut frames: Vec<i64> = recording.frames().iter().copied().filter(|frame| Some(*frame) <= last).collect();
        frames.sort_unstable_by_key(|frame| playback.time(*frame));
        let mut frames = frames.into_iter().peekable();
        let mut order: Vec<usize> = (0..windows.len()).collect();
        order.sort_by_key(|&index| playback.now(&windows[index]));
        let mut windows = windows;
        for index in order {
            let now = playback.now(&windows[index]);
            while let Some(frame) = frames.next_if(|frame| playback.time(*frame) < now) {
                let positions = recording.at(frame).iter().map(|seen| (seen.pedestrian, seen.position));
                self.observe(playback.time(frame), positions)?;
            }
            windows[index] = self.recalling(windows[index].clone(), count);
        }
        Ok(windows)
    }

    /// The window with at most `count` remembered tracks per pedestrian; their own running tracks are left out.
    #[must_use]
    pub fn recalling(&self, window: Window, count: usize) -> Window {
        let recall = |i: usize| {
            let own = Some(window.pedestrians()[i]);
            match window.observed(i).first_chunk() {
                Some(observed) if window.quality(i).is_hardly_observed() => {
                    self.recall_at(observed[OBSERVED - 1], own, count)
                }
                Some(observed) => self.recall(observed, own, count),
                None => Vec::new(),
            }
        };
        let remembered: Vec<_> = (0..window.len()).map(recall).collect();
        let mut remembered = remembered.into_iter();
        let bystanders = window.bystanders().map(|window| self.recalling(window.clone(), count));
        window.with_remembered(|_| remembered.next().unwrap_or_default()).with_bystanders(bystanders)
    }

    /// Observes a whole recording, and ends all tracks.
    ///
    /// # Errors
    /// [`MemoryError`] if the number of raw frames per step differs between recording and memory. The memory is then
    /// unchanged.
    pub fn observe_recording(&mut self, recording: &Recording) -> Result<(), MemoryError> {
        self.ensure_step_of(recording)?;
        self.end_tracks();
        for &frame in recording.frames() {
            let positions = recording.at(frame).iter().map(|seen| (seen.pedestrian, seen.position));
            self.observe(frame, positions)?;
        }
        self.end_tracks();
        Ok(())
    }

    fn ensure_step_of(&self, recording: &Recording) -> Result<(), MemoryError> {
        let (memory, recording) = (self.frame_step(), recording.frame_step());
        if memory == recording { Ok(()) } else { Err(MemoryError::OtherFrameStep { memory, recording }) }
    }
}
