//! The options that choose tracks, and the windows cut from them.

use crate::telling::{tell, tell_note};
use crate::units::{ReadRecording, Units};
use anyhow::{Context as _, bail};
use clap::Args;
use ddl::data::LiveTracks;
use ddl::{Note, ObservedTracks, RunConfig, WindowOptions};
use ddl_mcap::TrackTopic;
use std::path::{Path, PathBuf};

/// The tracks to read, and their units.
#[derive(Debug, Args)]
pub(crate) struct TrackOptions {
    /// Tracks: csv with the header frame,pedestrian,x,y in metres, or time (seconds or dates) instead of frame
    ///
    /// Also TrajNet++ ndjson, ETH obsmat.txt or the files of a data convention, recognised by extension and first
    /// lines; MCAP files and folders of rosbag2. `ddl forecast -` reads the lines of a live tracker.
    #[arg(value_name = "TRACKS")]
    file: PathBuf,
    #[command(flatten)]
    pub(crate) units: Units,
    /// Only pedestrians tracked for all 8 observed steps, 2.8 s from the first to the last
    ///
    /// By default, pedestrians are forecast from their first row on. Their motion is continued backwards before the
    /// first row; the column `unseen` counts such steps.
    #[arg(long)]
    whole: bool,
    /// Carry pedestrians on until their last row is so old; 0: only those with a row at the moment [default: 0.4, or
    /// the time between the last rows of a pedestrian if that is longer]
    #[arg(long, value_name = "SECONDS", value_parser = seconds, allow_negative_numbers = true)]
    max_age: Option<f64>,
    /// Time between two forecasts [default: 0, every frame; 0.4 in files where each pedestrian has its own clock]
    #[arg(long, value_name = "SECONDS", value_parser = seconds, allow_negative_numbers = true)]
    every: Option<f64>,
    /// Only the last frame with a forecast, instead of every frame
    #[arg(long)]
    last: bool,
}

impl TrackOptions {
    pub(crate) fn are_live(&self) -> bool {
        self.file().as_os_str() == "-"
    }

    pub(crate) fn file(&self) -> &Path {
        &self.file
    }

    /// Whether some pedestrians or frames are not to be forecast.
    pub(crate) fn are_thinned(&self) -> bool {
        self.whole || self.every.is_some()
    }

    /// The windows that the options ask for.
    pub(crate) fn windows(&self) -> WindowOptions {
        WindowOptions { whole: self.whole, max_age: self.max_age, every: self.every, last: self.last }
    }

    pub(crate) fn live_units(&self, run: &RunConfig) -> anyhow::Result<Units> {
        if self.last {
            bail!("--last does not apply to live tracks: every frame of standard input is forecast as it arrives");
        }
        Ok(self.units.or_those_of(run))
    }

    /// Windows of 8 observed steps, one for each moment with pedestrians to forecast, for a run; of a log, its topic.
    pub(crate) fn observed(&self, run: &RunConfig) -> anyhow::Result<(ObservedTracks, Option<TrackTopic>)> {
        let ReadRecording { topic, timed, .. } = self.units.or_those_of(run).read(self.file())?;
        timed.notes.iter().chain(&timed.guessed).for_each(tell_note);
        let tracks = self.windows().tracks(timed.recording.live_tracks())?;
        let observed = ObservedTracks::new((timed.recording, timed.clock), tracks, self.last);
        if !observed.has_common_frames && self.windows().are_all() {
            tell(format_args!("{} (--every; of occupancy --moments-every)", Note::OwnClocks.line()));
        }
        if let Some(warning) = &observed.warning {
            tell_note(&Note::Implausible(warning.clone()));
        }
        if let Some(problem) = observed.problem() {
            bail!("{}: {problem}", self.file().display());
        }
        Ok((observed, topic))
    }
}

fn seconds(text: &str) -> anyhow::Result<f64> {
    let longest = LiveTracks::LONGEST_GAP;
    let number = text.parse().ok().filter(|number| (0.0..=longest).contains(number));
    number.with_context(|| format!("must be a number from 0 to {longest}"))
}
