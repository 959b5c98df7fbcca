//! What was observed of a recording, and what is doubtful about it.

use crate::note::{MisfitNote, Note};
use crate::tracks::timed::many_frames;
use ddl_core::{OBSERVED, ObservationQuality, PedestrianId, Setting, TIME_STEP, Window};
use ddl_data::{Clock, Completeness, FrameNumber, LiveTracks, Misfit, PlausibilityWarning, Recording};
use std::collections::BTreeSet;
use std::sync::Arc;

/// Noise (m) from which on observed paths are smoothed.
const NOISY: f64 = 0.04;

/// Windows of 8 observed steps of a recording, one for each moment with pedestrians to forecast.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct ObservedTracks {
    /// The recording, in ticks of its clock.
    pub recording: Arc<Recording>,
    /// The windows.
    pub windows: Vec<Window>,
    /// The clock of frames or times.
    pub clock: Clock,
    /// A fault that the speeds suggest, such as wrong units or a wrong rate, which give meaningless forecasts; with
    /// frame numbers of the file.
    pub warning: Option<PlausibilityWarning>,
    /// Whether the pedestrians share frames.
    pub has_common_frames: bool,
    /// Rows that were left out, or began a track anew.
    misfits: Vec<Misfit>,
    noise: f64,
    never_forecast: Vec<PedestrianId>,
    completeness: Completeness,
}

impl ObservedTracks {
    /// The windows that these tracks, empty until now, make of the recording: all of them, or only the last.
    pub fn new((recording, clock): (impl Into<Arc<Recording>>, Clock), tracks: LiveTracks, last: bool) -> Self {
        let recording = recording.into();
        let completeness = tracks.completeness();
        let (mut windows, mut is_forecast) = (Vec::new(), BTreeSet::new());
        let observed = recording.observe_each(tracks, |window| {
            is_forecast.extend(window.pedestrians().iter().copied());
            if last {
                windows.clear();
            }
            windows.push(window);
        });
        let warning = recording
            .speed_warning()
            .filter(|warning| *warning != PlausibilityWarning::NoSteps)
            .map(|warning| in_frames(clock, warning));
        let mut never_forecast = recording.pedestrians();
        never_forecast.retain(|pedestrian| !is_forecast.contains(pedestrian));
        Self {
            recording,
            windows,
            clock,
            warning,
            has_common_frames: observed.has_common_frames,
            misfits: observed.misfits,
            noise: observed.noise.metres(),
            never_forecast,
            completeness,
        }
    }

    /// Why there is no window; `None` if there is one, as always where single rows are enough.
    pub fn problem(&self) -> Option<NobodyObserved> {
        let step = || (!self.clock.counts_times()).then(|| steps_in_words(self.clock));
        self.windows.is_empty().then(|| NobodyObserved { step: step() })
    }

    /// What was estimated and left out, because a forecast from one position looks like any other.
    pub fn estimated(&self) -> Vec<Note> {
        let mut notes = Vec::new();
        let windows = self.windows.iter();
        let qualities: Vec<ObservationQuality> =
            windows.flat_map(|window| (0..window.len()).map(|i| window.quality(i))).collect();
        let late = qualities.iter().filter(|quality| !quality.is_whole()).count();
        let hardly = qualities.iter().filter(|quality| quality.is_hardly_observed()).count();
        let carried = qualities.iter().filter(|quality| quality.age > 0.0).count();
        if late + carried > 0 {
            notes.push(Note::Estimated { forecasts: qualities.len(), late, hardly, carried });
        }
        notes.extend(noise(self.noise));
        let rest = [self.misfits(), self.never_forecast(), self.ends_early()];
        notes.extend(rest.into_iter().flatten());
        notes
    }

    /// The rows that do not fit their tracks.
    pub fn misfits(&self) -> Option<Note> {
        misfits_of(&self.recording, self.clock, &self.misfits, self.warning.as_ref())
    }

    /// The pedestrians who are in no window, unless only those tracked for all 8 steps are asked for.
    pub fn never_forecast(&self) -> Option<Note> {
        let first = self.never_forecast.first().filter(|_| self.completeness != Completeness::Whole)?;
        Some(Note::NeverForecast {
            count: self.never_forecast.len(),
            of: self.recording.pedestrians().len(),
            first: self.recording.names().of(*first),
        })
    }

    fn ends_early(&self) -> Option<Note> {
        let last = self.windows.last()?.frames()[OBSERVED - 1];
        let end = *self.recording.frames().last()?;
        let gap = (end - last) as f64 * TIME_STEP / self.recording.frame_step() as f64;
        let [end, last] = [end, last].map(|tick| self.clock.words(tick));
        (gap > LiveTracks::LONGEST_GAP).then_some(Note::EndsEarly { end, last })
    }
}

/// No pedestrian can be forecast.
#[derive(Debug, Clone, PartialEq)]
pub struct NobodyObserved {
    /// A step of 0.4 s, of frame numbers.
    step: Option<String>,
}

impl std::error::Error for NobodyObserved {}

impl std::fmt::Display for NobodyObserved {
    fn fmt(&self, to: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(to, "no pedestrian was tracked for all {OBSERVED} steps")?;
        match &self.step {
            Some(step) => {
                let [fps, frames] = [Setting::Fps, Setting::FrameStep];
                write!(to, " (a step of 0.4 s is taken as {step}); check {fps} or {frames}, and give")?;
            }
            None => to.write_str("; give")?,
        }
        write!(to, " {} or {} if positions are not in metres", Setting::Unit, Setting::Homography)
    }
}

/// A note if positions are so noisy that observed paths are smoothed.
pub fn noise(metres: f64) -> Option<Note> {
    (metres >= NOISY).then_some(Note::Noise { metres })
}

/// A step of 0.4 s as the file counts it.
pub fn steps_in_words(clock: Clock) -> String {
    match clock.step_number() {
        FrameNumber::Whole(step) => many_frames(step),
        step => format!("{step} frames"),
    }
}

/// The warning with frame numbers or times of the file.
pub fn in_frames(clock: Clock, mut warning: PlausibilityWarning) -> PlausibilityWarning {
    if let PlausibilityWarning::Jump { fastest, when } = &mut warning {
        *when = clock.words(fastest.frame);
    }
    warning
}

/// The rows that do not fit their tracks. With a warning of fast steps there is none: nearly all positions are in other
/// units.
pub fn misfits_of(
    recording: &Recording,
    clock: Clock,
    misfits: &[Misfit],
    warning: Option<&PlausibilityWarning>,
) -> Option<Note> {
    if misfits.is_empty() || matches!(warning, Some(PlausibilityWarning::Fast { .. })) {
        return None;
    }
    Some(Note::Misfits { scene: None, misfits: MisfitNote::all(misfits, recording.names(), clock) })
}
