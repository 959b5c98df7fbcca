//! What was observed of a recording, and what is doubtful about it.

use crate::tracks::timed::many_frames;
use ddl_core::{OBSERVED, ObservationQuality, PedestrianId, TIME_STEP, Window};
use ddl_data::{Clock, Completeness, FrameNumber, LiveTracks, Misfit, Observation, PlausibilityWarning, Recording};
use std::collections::BTreeSet;
use std::sync::Arc;

/// Noise (m) from which on observed paths are smoothed.
pub const NOISY: f64 = 0.04;

/// What is assumed of recordings without common frames.
pub const OWN_CLOCKS: &str = "each pedestrian has a clock of its own: moments are about 0.4 s apart";

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

    /// Why there is no window; `None` if there is one.
    pub fn problem(&self) -> Option<String> {
        self.windows.is_empty().then(|| {
            let too_few = if self.completeness == Completeness::Whole {
                "was tracked for all 8 steps"
            } else {
                "has two rows that fit, at most 2 s apart"
            };
            let rate = if self.clock.counts_times() {
                "; give".to_owned()
            } else {
                let step = steps_in_words(self.clock);
                format!(" (a step of 0.4 s is taken as {step}); check --fps or --frame-step, and give")
            };
            format!("no pedestrian {too_few}{rate} --unit or --homography if positions are not in metres")
        })
    }

    /// What was estimated and left out, a line each, because a forecast from two positions looks like any other.
    pub fn estimated(&self) -> Vec<String> {
        let mut told = Vec::new();
        let windows = self.windows.iter();
        let qualities: Vec<ObservationQuality> =
            windows.flat_map(|window| (0..window.len()).map(|i| window.quality(i))).collect();
        let late = qualities.iter().filter(|quality| !quality.is_whole()).count();
        let carried = qualities.iter().filter(|quality| quality.age > 0.0).count();
        if late + carried > 0 {
            told.push(format!(
                "note: of {} forecasts {late} are of pedestrians tracked for less than {OBSERVED} steps, and {carried} \
                 of pedestrians last seen a little before (columns unseen and age); --whole and --max-age leave them \
                 out",
                qualities.len()
            ));
        }
        if self.noise >= NOISY {
            told.push(format!(
                "note: the positions are noisy, {:.0} cm on each axis: observed paths are smoothed",
                100.0 * self.noise
            ));
        }
        told.extend(self.misfits().map(|words| format!("warning: {words}")));
        told.extend(self.never_forecast().map(|words| format!("note: {words}")));
        told.extend(self.missing());
        told.extend(self.ends_early());
        told
    }

    /// A sentence about rows that do not fit their tracks.
    pub fn misfits(&self) -> Option<String> {
        words_of_misfits(&self.recording, self.clock, &self.misfits, self.warning.as_ref())
    }

    /// A sentence about pedestrians who are in no window, unless only those tracked for all 8 steps are asked for.
    pub fn never_forecast(&self) -> Option<String> {
        let mut missing = self.never_forecast.iter();
        let first = missing.next().filter(|_| self.completeness != Completeness::Whole)?;
        Some(format!(
            "{} of {} pedestrians are never forecast, first {}: a forecast needs two rows that fit, at most 2 s apart",
            self.never_forecast.len(),
            self.recording.pedestrians().len(),
            self.recording.names().of(*first)
        ))
    }

    /// A note on a file that goes on after its last window.
    fn ends_early(&self) -> Option<String> {
        let last = self.windows.last()?.frames()[OBSERVED - 1];
        let end = *self.recording.frames().last()?;
        let gap = (end - last) as f64 * TIME_STEP / self.recording.frame_step() as f64;
        (gap > LiveTracks::LONGEST_GAP).then(|| {
            let [end, last] = [end, last].map(|tick| self.clock.words(tick));
            format!("note: there is no forecast for the last frame of the file ({end}); the last one is at {last}")
        })
    }

    /// A note on the pedestrians at the last moment who are in no window.
    fn missing(&self) -> Option<String> {
        let window = self.windows.last().filter(|_| self.completeness != Completeness::Whole)?;
        let last = window.frames()[OBSERVED - 1];
        let rows = self.recording.at(last);
        let is_missing = |row: &&Observation| !window.pedestrians().contains(&row.pedestrian);
        let missing = rows.iter().filter(is_missing).count();
        (missing > 0).then(|| {
            format!(
                "note: {missing} of the {} pedestrians at {} are not forecast: it is their first row, or their \
                 position is doubtful",
                rows.len(),
                self.clock.words(last)
            )
        })
    }
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

/// A sentence about rows that do not fit their tracks. With a warning of fast steps, nearly all positions are in other
/// units.
pub fn words_of_misfits(
    recording: &Recording,
    clock: Clock,
    misfits: &[Misfit],
    warning: Option<&PlausibilityWarning>,
) -> Option<String> {
    if matches!(warning, Some(PlausibilityWarning::Fast { .. })) {
        return None;
    }
    Misfit::words(misfits, |misfit| {
        let name = recording.names().of(misfit.pedestrian);
        format!("pedestrian {name} at {}", clock.words(misfit.tick))
    })
}

/// The warning with the options of the program that correct its cause.
pub fn words_of_warning(warning: &PlausibilityWarning) -> String {
    let options = match warning {
        PlausibilityWarning::Fast { .. } => " (--unit, --homography, or --fps of frame numbers)",
        PlausibilityWarning::Slow { .. } | PlausibilityWarning::NoSteps => " (--fps of frame numbers)",
        _ => "",
    };
    format!("{warning}{options}")
}
