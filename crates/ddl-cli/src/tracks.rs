//! The options that choose tracks, and the windows cut from them.

use crate::recordings;
use crate::telling::tell;
use crate::units::{ReadRecording, Units, many_frames};
use anyhow::bail;
use clap::Args;
use ddl::RunConfig;
use ddl::data::{
    Clock, Completeness, FrameNumber, LiveTracks, Misfit, OBSERVED, Observation, ObservationQuality, PedestrianId,
    PlausibilityWarning, Recording, Window,
};
use ddl_mcap::TrackTopic;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Noise (m) from which on observed paths are smoothed.
pub(crate) const NOISY: f64 = 0.04;

/// The tracks to read, and their units. A command that needs them requires `file`.
#[derive(Debug, Args)]
pub(crate) struct TrackOptions {
    /// Tracks: csv with the header frame,pedestrian,x,y in metres (or time, in seconds, instead of frame); the rows of
    /// a pedestrian are 0.4 s apart unless --fps or --dt is given
    ///
    /// Also TrajNet++ ndjson, ETH obsmat.txt or the files of a data convention, recognised by extension and first
    /// lines; MCAP files and folders of rosbag2. `ddl forecast -` reads the lines of a live tracker.
    #[arg(value_name = "TRACKS")]
    file: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) units: Units,
    /// Only pedestrians tracked for all 8 observed steps, 2.8 s
    ///
    /// By default, pedestrians with 2 or more rows are forecast too. Their motion is continued backwards before the
    /// first row; the column `unseen` counts such steps.
    #[arg(long, requires = "file")]
    whole: bool,
    /// Carry pedestrians on until their last row is so old; 0: only those with a row at the moment [default: 0.4, or
    /// the time between the last rows of a pedestrian if that is longer]
    #[arg(long, requires = "file", value_name = "SECONDS", value_parser = seconds, allow_negative_numbers = true)]
    max_age: Option<f64>,
    /// Time between two forecasts [default: 0, every frame; 0.4 in files where each pedestrian has its own clock]
    #[arg(long, requires = "file", value_name = "SECONDS", value_parser = seconds, allow_negative_numbers = true)]
    every: Option<f64>,
    /// Only the last frame with a forecast, instead of every frame
    #[arg(long, requires = "file")]
    last: bool,
}

#[derive(Debug)]
pub(crate) struct ObservedTracks {
    pub(crate) recording: Recording,
    /// Its topic in a log.
    pub(crate) topic: Option<TrackTopic>,
    pub(crate) windows: Vec<Window>,
    pub(crate) clock: Clock,
    /// A fault that the speeds suggest, such as wrong units or a wrong rate, which give meaningless forecasts.
    pub(crate) warning: Option<PlausibilityWarning>,
    /// Rows that were left out, or began a track anew.
    misfits: Vec<Misfit>,
    noise: f64,
    never_forecast: Vec<PedestrianId>,
    whole: bool,
}

impl TrackOptions {
    pub(crate) fn are_live(&self) -> bool {
        self.file().as_os_str() == "-"
    }

    pub(crate) fn file(&self) -> &Path {
        self.file.as_deref().unwrap_or(Path::new(""))
    }

    pub(crate) fn are_named(&self) -> bool {
        self.file.is_some()
    }

    /// Whether some pedestrians or frames are not to be forecast.
    pub(crate) fn are_thinned(&self) -> bool {
        self.whole || self.every.is_some()
    }

    /// These tracks with the options' windows.
    pub(crate) fn windows_of(&self, tracks: LiveTracks) -> LiveTracks {
        let completeness = if self.whole {
            Completeness::Whole
        } else {
            Completeness::Partial
        };
        let tracks = tracks.with_completeness(completeness);
        tracks.with_max_age(self.max_age).with_interval(self.every)
    }

    pub(crate) fn live_units(&self, run: &RunConfig) -> anyhow::Result<Units> {
        if self.last {
            bail!("--last does not apply to live tracks: every frame of standard input is forecast as it arrives");
        }
        Ok(self.units.or_those_of(run))
    }

    /// Windows of 8 observed steps, one for each moment with pedestrians to forecast, for a run.
    pub(crate) fn observed(&self, run: &RunConfig) -> anyhow::Result<ObservedTracks> {
        let read = self.units.or_those_of(run).read(self.file())?;
        for note in read.notes.iter().chain(&read.guessed) {
            tell(format_args!("note: {note}"));
        }
        let ReadRecording { recording, clock, .. } = read;
        let mut tracks = self.windows_of(recording.live_tracks());
        if self.last && self.every.is_none() {
            // With clocks of their own, too, the last row is the last moment.
            tracks = tracks.with_interval(0.0);
        }
        let (mut windows, mut is_forecast) = (Vec::new(), BTreeSet::new());
        let observed = recording.observe_each(tracks, |window| {
            is_forecast.extend(window.pedestrians().iter().copied());
            if self.last {
                windows.clear();
            }
            windows.push(window);
        });
        if !observed.has_common_frames && self.every.is_none() && !self.last {
            tell(format_args!("note: {} (--every)", recordings::OWN_CLOCKS));
        }
        let warning = recording
            .speed_warning()
            .filter(|warning| !matches!(warning, PlausibilityWarning::NoSteps { .. }))
            .map(|warning| recordings::in_frames(clock, warning));
        if let Some(warning) = &warning {
            recordings::warn_of(warning);
        }
        if windows.is_empty() {
            bail!(
                "{}: no pedestrian {} (a step of 0.4 s is taken as {}); give --fps or --frame-step if frame numbers \
                 are not 0.4 s apart, and --homography if positions are not in metres",
                self.file().display(),
                if self.whole {
                    "was tracked for all 8 steps"
                } else {
                    "has two rows that fit, at most 2 s apart"
                },
                steps_in_words(clock)
            );
        }
        let mut never_forecast = recording.pedestrians();
        never_forecast.retain(|pedestrian| !is_forecast.contains(pedestrian));
        Ok(ObservedTracks {
            recording,
            topic: read.topic,
            windows,
            clock,
            warning,
            misfits: observed.misfits,
            noise: observed.noise.metres(),
            never_forecast,
            whole: self.whole,
        })
    }
}

impl ObservedTracks {
    /// Reports what was estimated and left out, because a forecast from two positions looks like any other.
    pub(crate) fn tell_what_was_estimated(&self) {
        let windows = self.windows.iter();
        let qualities: Vec<ObservationQuality> = windows
            .flat_map(|window| (0..window.len()).map(|i| window.quality(i)))
            .collect();
        let late = qualities.iter().filter(|quality| !quality.is_whole()).count();
        let carried = qualities.iter().filter(|quality| quality.age > 0.0).count();
        if late + carried > 0 {
            tell(format_args!(
                "note: of {} forecasts {late} are of pedestrians tracked for less than {OBSERVED} steps, and {carried} \
                 of pedestrians last seen a little before (columns unseen and age); --whole and --max-age leave them \
                 out",
                qualities.len()
            ));
        }
        if self.noise >= NOISY {
            tell(format_args!(
                "note: the positions are noisy, {:.0} cm on each axis: observed paths are smoothed",
                100.0 * self.noise
            ));
        }
        self.warn_of_misfits();
        if !self.whole {
            self.tell_who_is_missing();
        }
    }

    /// Warns of positions that are left out.
    pub(crate) fn warn_of_misfits(&self) {
        let warning = self.warning.as_ref();
        let words = recordings::words_of_misfits(&self.recording, self.clock, &self.misfits, warning);
        if let Some(words) = words {
            tell(format_args!("warning: {words}"));
        }
    }

    fn tell_who_is_missing(&self) {
        if let Some(&first) = self.never_forecast.first() {
            tell(format_args!(
                "note: {} of {} pedestrians are never forecast, first {}: a forecast needs two rows that fit, at most \
                 2 s apart",
                self.never_forecast.len(),
                self.recording.pedestrians().len(),
                self.recording.names().of(first)
            ));
        }
        let Some(window) = self.windows.last() else {
            return;
        };
        let last = window.frames()[OBSERVED - 1];
        let rows = self.recording.at(last);
        let is_missing = |row: &&Observation| !window.pedestrians().contains(&row.pedestrian);
        let missing = rows.iter().filter(is_missing).count();
        if missing > 0 {
            tell(format_args!(
                "note: {missing} of the {} pedestrians at frame {} are not forecast: it is their first row, or their \
                 position is doubtful",
                rows.len(),
                self.clock.number(last)
            ));
        }
    }
}

/// A step of 0.4 s as the file counts it.
pub(crate) fn steps_in_words(clock: Clock) -> String {
    match clock.step_number() {
        FrameNumber::Whole(step) => many_frames(step),
        step => format!("{step} frames"),
    }
}

fn seconds(text: &str) -> Result<f64, String> {
    let number: f64 = text.parse().map_err(|error| format!("must be a number: {error}"))?;
    if (0.0..=LiveTracks::LONGEST_GAP).contains(&number) {
        Ok(number)
    } else {
        Err(format!("must be a number from 0 to {}", LiveTracks::LONGEST_GAP))
    }
}
