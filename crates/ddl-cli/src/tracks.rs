//! The options that choose tracks, and the windows cut from them.

use crate::clock::{Clock, FrameNumber};
use crate::recordings;
use crate::telling::tell;
use crate::units::{ReadRecording, Units};
use anyhow::bail;
use clap::Args;
use ddl::RunConfig;
use ddl::data::{Completion, CompletionCounts, OBSERVED, Observation, PlausibilityWarning, Recording, Window};
use std::io::IsTerminal as _;
use std::path::{Path, PathBuf};

/// The tracks to read, and their units. A command that needs them requires `file`.
#[derive(Debug, Args)]
pub(crate) struct TrackOptions {
    /// Tracks: csv with the header frame,pedestrian,x,y in metres; the rows of a pedestrian are 0.4 s apart unless
    /// --fps or --dt is given
    ///
    /// Also TrajNet++ ndjson, ETH obsmat.txt or the files of a data convention, recognised by extension and first
    /// lines. `ddl forecast -` reads the lines of a live tracker.
    #[arg(value_name = "TRACKS")]
    file: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) units: Units,
    /// Only pedestrians observed at each of the last 8 time steps
    ///
    /// By default, pedestrians observed at 2 or more of them are forecast too. Gaps of up to 2 steps are filled on a
    /// straight line; positions before the first observation are padded at the mean observed velocity. The columns
    /// `padded` and `filled` count such positions.
    #[arg(long, requires = "file")]
    whole: bool,
    /// Only the last frame with a forecast, instead of every frame
    #[arg(long, requires = "file")]
    last: bool,
}

fn frames(count: FrameNumber) -> String {
    match count {
        FrameNumber::Whole(1) => "1 frame".to_owned(),
        count => format!("{count} frames"),
    }
}

#[derive(Debug)]
pub(crate) struct ObservedTracks {
    pub(crate) recording: Recording,
    pub(crate) windows: Vec<Window>,
    pub(crate) clock: Clock,
    /// A fault that the speeds suggest, such as wrong units or a wrong rate, which give meaningless forecasts.
    pub(crate) warning: Option<PlausibilityWarning>,
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

    pub(crate) fn completion(&self) -> Completion {
        if self.whole {
            Completion::NONE
        } else {
            Completion::DEFAULT
        }
    }

    pub(crate) fn live_units(&self, run: &RunConfig) -> anyhow::Result<Units> {
        if self.last {
            bail!("--last does not apply to live tracks: every frame of standard input is forecast as it arrives");
        }
        Ok(self.units.or_those_of(run))
    }

    /// Windows of 8 observed steps, one for each frame with pedestrians to forecast, for a run.
    pub(crate) fn observed(&self, run: &RunConfig) -> anyhow::Result<ObservedTracks> {
        let ReadRecording {
            recording,
            clock,
            guessed,
            notes,
        } = self.units.or_those_of(run).read(self.file())?;
        for note in notes {
            tell(format_args!("note: {note}"));
        }
        let mut windows = recording.completed_windows(self.completion());
        if windows.is_empty() {
            bail!(
                "{}: no pedestrian was observed {} (a step of 0.4 s is taken as {}); give --fps or --frame-step if \
                 frame numbers are not 0.4 s apart",
                self.file().display(),
                if self.whole {
                    "at 8 consecutive time steps, 3.2 s"
                } else {
                    "at 2 consecutive time steps"
                },
                frames(clock.number(recording.frame_step()))
            );
        }
        // The note is shown only on a terminal, where the user may be trying the tracks for the first time.
        if guessed && std::io::stderr().is_terminal() {
            tell(format_args!(
                "note: a step of 0.4 s is taken as {}, the most common difference of two rows; give --fps, --dt or \
                 --frame-step if this is wrong",
                frames(clock.number(recording.frame_step()))
            ));
        }
        let warning = recording
            .speed_warning()
            .filter(|warning| !matches!(warning, PlausibilityWarning::NoSteps { .. }))
            .map(|warning| clock.of_warning(warning));
        if let Some(warning) = &warning {
            recordings::warn_of(warning);
        }
        if self.last {
            windows.drain(..windows.len() - 1);
        }
        Ok(ObservedTracks {
            recording,
            windows,
            clock,
            warning,
            whole: self.whole,
        })
    }
}

impl ObservedTracks {
    /// Reports incomplete observations, because a forecast from two positions looks like any other.
    pub(crate) fn tell_what_is_made_up(&self) {
        let windows = self.windows.iter();
        let counts_of_all: Vec<CompletionCounts> = windows
            .flat_map(|window| (0..window.len()).map(|i| window.completion_counts(i)))
            .collect();
        let late = counts_of_all.iter().filter(|counts| counts.padded > 0).count();
        let gaps = counts_of_all.iter().filter(|counts| counts.filled > 0).count();
        if late + gaps > 0 {
            tell(format_args!(
                "note: of {} forecasts {late} are of pedestrians observed at fewer than {OBSERVED} time steps, and \
                 {gaps} over filled gaps (columns padded and filled); --whole leaves them out",
                counts_of_all.len()
            ));
        }
        if !self.whole {
            self.tell_who_is_missing();
        }
    }

    fn tell_who_is_missing(&self) {
        let Some(window) = self.windows.last() else {
            return;
        };
        let last = window.frames()[OBSERVED - 1];
        let there = |seen: &&Observation| seen.frame == last;
        let present = self.recording.observations().iter().filter(there).count();
        let missing = present.saturating_sub(window.len());
        if missing > 0 {
            let frame = self.clock.number(last);
            tell(format_args!(
                "note: {missing} of the {present} pedestrians at frame {frame} were observed at too few of the last \
             {OBSERVED} time steps and are not forecast"
            ));
        }
    }
}
