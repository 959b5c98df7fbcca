//! A window with its forecast, as the file counts time.

use crate::forecast::answer::Answer;
use ddl_core::{HORIZON, OBSERVED, Window};
use ddl_data::{Clock, FrameNumber, SceneName};

/// The forecast at one frame.
#[derive(Debug, Clone, Copy)]
pub struct Moment<'a> {
    /// The scene, if the tracks name scenes.
    pub scene: Option<&'a SceneName>,
    /// The observed pedestrians.
    pub window: &'a Window,
    /// Their forecast, as it was asked for.
    pub answer: &'a Answer,
    /// The clock of the window.
    pub clock: Clock,
}

impl<'a> Moment<'a> {
    /// A moment of a place without scene names.
    pub fn new(window: &'a Window, answer: &'a Answer, clock: Clock) -> Self {
        Self { scene: None, window, answer, clock }
    }

    /// The name of a pedestrian in messages.
    pub fn who(&self, i: usize) -> String {
        let name = self.window.name(i);
        match self.scene {
            None => name.to_string(),
            Some(scene) => format!("{name} of scene {scene}"),
        }
    }

    /// The last observed frame.
    pub fn observed_until(&self) -> FrameNumber {
        self.clock.number(self.window.frames()[OBSERVED - 1])
    }

    /// The last observed frame, or its time, in words.
    pub fn when(&self) -> String {
        self.clock.words(self.window.frames()[OBSERVED - 1])
    }

    /// The moment in microseconds.
    pub fn microseconds(&self) -> i64 {
        self.clock.microseconds(self.window.frames()[OBSERVED - 1])
    }

    /// The 12 frames of the forecast.
    pub fn frames(&self) -> Vec<FrameNumber> {
        let (last, step) = (self.window.frames()[OBSERVED - 1], self.window.frame_step());
        (1..=HORIZON as i64).map(|t| self.clock.number(last + t * step)).collect()
    }
}
