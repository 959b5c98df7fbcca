//! The commands that answer every moment of a file of tracks or of live tracks.

use crate::command::forecast::live;
use crate::command::forecast::moment::{SceneWindows, StreamState, warn_of_violation};
use crate::command::{Machine, ModelChoice};
use crate::interrupt::Interrupt;
use crate::output::{file_of, write_file, write_parts};
use crate::telling::tell;
use crate::tracks::{TrackOptions, tell_what_was_estimated};
use anyhow::bail;
use clap::{Args, ValueEnum};
use ddl::data::{Clock, Window};
use ddl::{CertifiedForecast, Ddl, DdlError, Moment};
use ddl_mcap::ForecastLog;
use std::fs::File;
use std::io::IsTerminal as _;
use std::path::PathBuf;

/// Number of lines above which a terminal gets a note.
const LOOKED_THROUGH: usize = 100;
/// Forecasts of so many pedestrians take some 30 MB as text.
const AT_ONCE: usize = 1024;
/// Bytes above which the output counts as large.
const LARGE: usize = 50 << 20;

/// The model, the tracks and the output of such a command.
#[derive(Debug, Args)]
pub(crate) struct StreamOptions {
    #[command(flatten)]
    pub(super) model: ModelChoice,
    #[command(flatten)]
    pub(super) tracks: TrackOptions,
    /// File to write [default: standard output, also as `-`]; forecasts also as .mcap, for Foxglove and ROS 2
    #[arg(long, short)]
    pub(crate) output: Option<PathBuf>,
    /// With `-`: file of a scene memory, the earlier tracks of this place, which improves forecasts; created if
    /// missing, written every minute and at the end
    ///
    /// Use one file for each camera; for a stream of several scenes an existing folder, which gets a file SCENE.memory
    /// for each. The first 30 pedestrians show whether the memory is of this place; if it is not, the file is left
    /// unchanged and forecasts continue without it. `ddl data FILE` summarises the file.
    #[arg(long, value_name = "FILE")]
    pub(super) memory: Option<PathBuf>,
    /// With `-`: if frames arrive faster than they are forecast, forecast only the latest of each scene, and report how
    /// many were dropped
    ///
    /// Without it every frame is forecast, and the writer of the stream has to wait. Tracks and memory use every frame
    /// in both cases. With a file as input nearly all frames would be dropped.
    #[arg(long)]
    pub(super) latest: bool,
    #[command(flatten)]
    pub(super) machine: Machine,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum OutputFormat {
    Csv,
    Jsonl,
}

/// A command that answers moments with text.
pub(crate) trait Answer {
    fn stream(&self) -> &StreamOptions;

    /// The forecasts that its answers need: the joint futures of each window.
    fn forecasts(
        &self,
        model: &Ddl,
        windows: SceneWindows<'_>,
        _state: &mut StreamState,
    ) -> anyhow::Result<Vec<CertifiedForecast>> {
        let forecasts = model.forecast_scenes(windows.windows, None)?;
        Ok(forecasts.into_iter().map(Into::into).collect())
    }

    /// About so many pedestrians are forecast and written at once.
    fn at_once(&self) -> usize {
        AT_ONCE
    }

    /// Adds the answers of the moments to a log.
    fn log(&self, _moments: &[Moment<'_>], _log: &mut ForecastLog<&mut File>) -> anyhow::Result<()> {
        bail!("only forecasts are written as MCAP; name another file for --output")
    }

    /// The answers of the moments in order of time. The first text starts with the names of the columns, if the format
    /// has any.
    fn text(&self, moments: &[Moment<'_>], state: &mut StreamState) -> anyhow::Result<String>;
}

/// The answers of a command for these windows, as text.
pub(super) fn text_of(
    command: &dyn Answer,
    model: &Ddl,
    windows: SceneWindows<'_>,
    clock: Clock,
    state: &mut StreamState,
) -> anyhow::Result<String> {
    answers_of(command, model, windows, clock, state, |moments, state| command.text(moments, state))
}

fn answers_of<T>(
    command: &dyn Answer,
    model: &Ddl,
    windows: SceneWindows<'_>,
    clock: Clock,
    state: &mut StreamState,
    answers: impl FnOnce(&[Moment<'_>], &mut StreamState) -> anyhow::Result<T>,
) -> anyhow::Result<T> {
    let forecasts = command.forecasts(model, windows, state)?;
    let moments = windows.moments(&forecasts, clock);
    warn_of_violation(&moments, state);
    state.unfamiliar.add(&moments);
    if command.stream().tracks.are_live()
        && let Some(warning) = state.unfamiliar.warning()
    {
        tell(format_args!("{warning}; this warning appears once, but each forecast has its familiarity"));
    }
    answers(&moments, state)
}

/// Answers every moment of the tracks.
pub(crate) fn answer(command: &dyn Answer) -> anyhow::Result<()> {
    let stream = command.stream();
    stream.machine.prepare_for_little()?;
    if stream.memory.is_some() && !stream.tracks.are_live() {
        bail!(
            "--memory is for live tracks from standard input, as in `ddl forecast - --memory FILE`: give \
             `-` for the file"
        );
    }
    if stream.latest && !stream.tracks.are_live() {
        bail!("--latest is for tracks as they come; write them to standard input, and give `-` instead of a file");
    }
    let log = stream.output.as_deref().filter(|path| ddl_mcap::is_mcap(path));
    if stream.tracks.are_live() {
        if let Some(path) = log {
            bail!("{}: MCAP is written from a file of tracks, not from standard input", path.display());
        }
        return live::run(command);
    }
    let model = stream.load()?;
    let (observed, topic) = stream.tracks.observed(model.config())?;
    let mut state = StreamState::default();
    state.frame_id = topic.as_ref().and_then(|topic| topic.frame_id.clone());
    let (mut lines, mut bytes) = (0, 0);
    let interrupt = Interrupt::catch()?;
    let parts = Window::parts(&observed.windows, command.at_once()).map(|windows| {
        // No unfinished file is left.
        if interrupt.flow().is_break() {
            bail!(DdlError::Interrupted);
        }
        Ok(SceneWindows { windows, scenes: &[] })
    });
    if let Some(path) = log {
        write_file(path, |file| {
            let mut log = ForecastLog::new(file, topic.as_ref())?;
            if let Some(frame) = log.assumed_frame() {
                tell(format_args!("note: coordinate frame assumed: {frame}"));
            }
            for windows in parts {
                let add = |moments: &[Moment<'_>], _: &mut StreamState| command.log(moments, &mut log);
                answers_of(command, &model, windows?, observed.clock, &mut state, add)?;
            }
            Ok(log.finish()?)
        })?;
    } else {
        let texts = parts.map(|windows| {
            let text = text_of(command, &model, windows?, observed.clock, &mut state)?;
            bytes += text.len();
            lines += text.lines().count();
            Ok(text)
        });
        write_parts(stream.output.as_deref(), texts)?;
    }
    if let Some(warning) = state.unfamiliar.warning() {
        tell(format_args!("{warning}"));
    }
    stream.warn_of_flood(lines, bytes);
    tell_what_was_estimated(&observed);
    Ok(())
}

impl StreamOptions {
    pub(super) fn load(&self) -> anyhow::Result<Ddl> {
        Ok(self.model.load(self.machine.device)?)
    }

    /// The format that was asked for, or that of the extension of the output.
    pub(crate) fn format(&self, asked: Option<OutputFormat>) -> OutputFormat {
        let extension = self.output.as_ref().and_then(|path| path.extension());
        asked.unwrap_or(if extension.is_some_and(|it| it.eq_ignore_ascii_case("jsonl")) {
            OutputFormat::Jsonl
        } else {
            OutputFormat::Csv
        })
    }

    /// Notes how to reduce large output: thousands of lines on a terminal, or a large file.
    fn warn_of_flood(&self, lines: usize, bytes: usize) {
        let on_terminal = file_of(self.output.as_deref()).is_none() && std::io::stdout().is_terminal();
        if on_terminal && lines > LOOKED_THROUGH {
            tell(format_args!(
                "note: {lines} lines; --output FILE writes them to a file, --last gives those of the last frame \
                 alone, `ddl view` shows forecasts"
            ));
        } else if bytes > LARGE {
            tell(format_args!(
                "note: {} MiB, because all pedestrians are forecast from every frame; --last takes the last alone",
                bytes >> 20
            ));
        }
    }
}
