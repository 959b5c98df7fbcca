//! The windows that a user asks for.

use ddl_core::Setting;
use ddl_data::{Completeness, LiveTracks};

/// Which windows are made of tracks.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct WindowOptions {
    /// Only pedestrians tracked for all 8 steps.
    pub whole: bool,
    /// The age of the last row (s) up to which a pedestrian is carried on; `None`: as its rows come.
    pub max_age: Option<f64>,
    /// The time between two windows (s); `None`: every frame, and 0.4 s where each pedestrian has its own clock.
    pub every: Option<f64>,
    /// Only the last window.
    pub last: bool,
}

/// Seconds that are out of range.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("{setting} is {seconds}; it must be a number of seconds from 0 to {}", LiveTracks::LONGEST_GAP)]
pub struct OutOfGap {
    /// The option.
    pub setting: Setting,
    /// What it is.
    pub seconds: f64,
}

impl WindowOptions {
    /// These tracks, which then make the windows.
    ///
    /// # Errors
    /// When seconds are not within 0 to 2.
    pub fn tracks(self, tracks: LiveTracks) -> Result<LiveTracks, OutOfGap> {
        for (setting, seconds) in [(Setting::MaxAge, self.max_age), (Setting::Every, self.every)] {
            if let Some(seconds) = seconds.filter(|seconds| !(0.0..=LiveTracks::LONGEST_GAP).contains(seconds)) {
                return Err(OutOfGap { setting, seconds });
            }
        }
        // With clocks of their own, too, the last row is the last moment.
        let every = self.every.or(self.last.then_some(0.0));
        Ok(tracks.with_completeness(Completeness::of(self.whole)).with_max_age(self.max_age).with_interval(every))
    }

    /// Whether every moment is to be forecast, as the tracks have them.
    pub fn are_all(self) -> bool {
        self.every.is_none() && !self.last
    }
}
