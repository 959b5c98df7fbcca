//! `ddl view`: a page that plays the forecasts of a recording.

use crate::command::{Machine, ModelChoice};
use crate::output;
use crate::paths::OutputFile;
use crate::telling::tell_note;
use crate::tracks::TrackOptions;
use anyhow::{Context as _, bail};
use clap::Args;
use ddl::{RecordingPlayer, Request};
use std::io::IsTerminal as _;
use std::path::PathBuf;

/// Show forecasts of your own tracks in the browser
///
/// Writes a self-contained page with a player of moments of the recording: all hypotheses with their weights, goals and
/// certificates, and the true paths as far as they were observed.
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  ddl view tracks.csv\n  \
                  ddl view tracks.csv --joint\n  \
                  ddl view camera.csv --fps 25 --homography H.txt --output lobby.html --no-open")]
pub(crate) struct ViewCommand {
    #[command(flatten)]
    model: ModelChoice,
    #[command(flatten)]
    tracks: TrackOptions,
    /// Moments to show, evenly spread over the recording
    #[arg(long, default_value_t = 60, value_parser = crate::command::at_least_one)]
    moments: usize,
    /// Show joint futures of all pedestrians, one at a time: people who walk together stay together
    #[arg(long)]
    joint: bool,
    /// Page to write [default: the name of the tracks with -forecasts.html, in the current folder]
    #[arg(long, short, value_hint = clap::ValueHint::AnyPath)]
    output: Option<OutputFile>,
    /// Do not open the page; by default it is opened if standard output is a terminal
    #[arg(long)]
    no_open: bool,
    #[command(flatten)]
    machine: Machine,
}

impl ViewCommand {
    pub(crate) fn run(self) -> anyhow::Result<()> {
        if self.tracks.are_live() {
            bail!("a page needs a file of tracks; for live tracks, use `ddl forecast -`");
        }
        self.machine.prepare_for_little()?;
        let model = self.model.load(self.machine.device)?;
        let (observed, _) = self.tracks.observed(model.config())?;
        let recording = &observed.recording;
        let player = RecordingPlayer { model: &model, recording, windows: &observed.windows, most: self.moments };
        let request = if self.joint { Request::joint() } else { Request::default() };
        let answers = model.forecast(&player.shown(), &request)?;
        let name = self.tracks.file().file_name().unwrap_or_default();
        let (warning, clock) = (observed.warning.as_ref(), observed.clock);
        let page = player.to_html(&answers, &name.to_string_lossy(), warning, clock)?;
        let beside = || {
            let stem = self.tracks.file().file_stem().unwrap_or_default();
            PathBuf::from(format!("{}-forecasts.html", stem.to_string_lossy()))
        };
        let path = self.output.map_or_else(beside, PathBuf::from);
        output::write_output(Some(&path), &page)?;
        player.unfamiliar(&answers, clock).iter().chain(&observed.misfits()).for_each(tell_note);
        if output::file_of(Some(&path)).is_none() {
            return Ok(());
        }
        output::print(&format!("{}\n", path.display()))?;
        if !self.no_open && std::io::stdout().is_terminal() {
            open::that_detached(&path).with_context(|| {
                let page = path.display();
                format!("the page is written, but no browser could be started; open {page} yourself, or add --no-open")
            })?;
        }
        Ok(())
    }
}
