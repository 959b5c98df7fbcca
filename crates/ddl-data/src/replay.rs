//! A recording, observed frame by frame as a live stream would be.

use ddl_core::{HORIZON, WINDOW, Window};

use crate::future::TruePaths;
use crate::live::{Completeness, LiveTracks};
use crate::observe::{Misfit, RecordingNoise};
use crate::recording::Recording;

/// What was observed of a recording, in order of time.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct ObservedRecording {
    /// The windows to forecast from: 8 positions without a future.
    pub windows: Vec<Window>,
    /// How exact the positions are.
    pub noise: RecordingNoise,
    /// Whether frames show several pedestrians, or each pedestrian has a clock of its own.
    pub has_common_frames: bool,
    /// The rows that were left out, or began a track anew.
    pub misfits: Vec<Misfit>,
}

impl Recording {
    /// Empty tracks with the name and clock of this recording. There is a window at every frame while
    /// frames show several pedestrians, and every 0.4 s while each pedestrian has a clock of its own, by the frames so
    /// far.
    #[must_use]
    pub fn live_tracks(&self) -> LiveTracks {
        LiveTracks::of_recording(self)
    }

    /// The windows that these tracks, empty until now, make of the recording.
    #[must_use]
    pub fn observe(&self, tracks: LiveTracks) -> ObservedRecording {
        let mut windows = Vec::new();
        let observed = self.observe_each(tracks, |window| windows.push(window));
        ObservedRecording { windows, ..observed }
    }

    /// As [`observe`](Self::observe), but hands over each window instead of keeping them all: none is returned.
    #[must_use]
    pub fn observe_each(&self, mut tracks: LiveTracks, mut each: impl FnMut(Window)) -> ObservedRecording {
        let mut misfits = Vec::new();
        for &frame in self.frames() {
            let rows = self.at(frame).iter().map(|row| (row.pedestrian, row.position));
            // Cannot fail: the invariants of a recording exclude every error of live tracks.
            if let Ok(Some(window)) = tracks.push(frame, rows) {
                each(window);
            }
            misfits.extend_from_slice(tracks.misfits());
        }
        ObservedRecording {
            windows: Vec::new(),
            noise: tracks.noise().clone(),
            has_common_frames: tracks.have_common_frames(),
            misfits,
        }
    }

    /// The windows of pedestrians that were tracked for all 8 steps.
    #[must_use]
    pub fn observed_windows(&self) -> Vec<Window> {
        self.observe(self.live_tracks()).windows
    }

    /// The observed windows with the futures of the pedestrians that were tracked for all 20 steps; the others are
    /// bystanders.
    pub(crate) fn windows_with_futures(&self) -> Vec<Window> {
        let futures = self.futures();
        let mut windows = Vec::new();
        let tracks = self.live_tracks().with_completeness(Completeness::Partial).without_doubt();
        let _ = self.observe_each(tracks, |window| windows.extend(self.with_future(&window, &futures)));
        windows
    }

    /// The window with the futures of its pedestrians tracked for all 20 steps; `None` if there are none.
    pub(crate) fn with_future(&self, window: &Window, futures: &TruePaths<'_>) -> Option<Window> {
        let future = futures.after(window);
        let is_known = |i: usize| window.quality(i).is_whole() && future[i].len() == HORIZON;
        let scored = window.filter_pedestrians(is_known)?;
        let (first, step) = (window.start_frame(), window.frame_step());
        let tracks = (0..window.len()).filter(|&i| is_known(i));
        let positions = tracks.flat_map(|i| window.observed(i).iter().chain(&future[i]).copied());
        let frames = (0..WINDOW as i64).map(|t| first + t * step).collect();
        let pedestrians = scored.pedestrians().to_vec();
        let whole = Window::cut(self.shared_name(), step, frames, pedestrians, positions.collect());
        let qualities = (0..scored.len()).map(|i| scored.quality(i)).collect();
        let whole = whole.with_names(self.names().clone()).with_qualities(qualities);
        Some(whole.with_bystanders(window.filter_pedestrians(|i| !is_known(i))))
    }
}
