//! The options and the answers of the commands that answer every moment of tracks.

use crate::command::forecast::state::StreamState;
use crate::command::{Machine, ModelChoice};
use crate::output::file_of;
use crate::paths::{MemoryPath, OutputFile};
use crate::telling::tell;
use crate::tracks::TrackOptions;
use anyhow::bail;
use clap::{Args, ValueEnum};
use ddl::data::Clock;
use ddl::{Answer, Ddl, Moment, Note, Request, SceneWindows};
use ddl_mcap::ForecastLog;
use std::fs::File;
use std::io::IsTerminal as _;

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
    #[arg(long, short, value_hint = clap::ValueHint::AnyPath)]
    pub(crate) output: Option<OutputFile>,
    /// With `-`: file of a scene memory, the earlier tracks of this place, which improves forecasts; created if
    /// missing, written every minute and at the end
    ///
    /// Use one file for each camera; for a stream of several scenes an existing folder, which gets a file SCENE.memory
    /// for each. The first 30 pedestrians show whether the memory is of this place; if it is not, the file is left
    /// unchanged and forecasts continue without it. `ddl data FILE` summarises the file.
    #[arg(long, value_name = "FILE", value_hint = clap::ValueHint::AnyPath)]
    pub(super) memory: Option<MemoryPath>,
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
pub(crate) trait AnsweringCommand {
    fn stream(&self) -> &StreamOptions;

    /// What it asks of the model now: the joint futures of each window.
    fn request(&self, _state: &mut StreamState) -> anyhow::Result<Request> {
        Ok(Request::joint())
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

/// What a command makes of the answers to these windows.
pub(super) fn answers_of<T>(
    command: &dyn AnsweringCommand,
    windows: SceneWindows<'_>,
    clock: Clock,
    state: &mut StreamState,
    answer: impl FnOnce(SceneWindows<'_>, Request) -> anyhow::Result<Vec<Answer>>,
    make: impl FnOnce(&[Moment<'_>], &mut StreamState) -> anyhow::Result<T>,
) -> anyhow::Result<T> {
    let request = command.request(state)?;
    let answers = answer(windows, request.clone())?;
    let moments = windows.moments(&answers, clock);
    for moment in &moments {
        state.tell_notes_once(Note::of_given(request.plan(), moment.window, moment.answer), moment);
    }
    state.warn_of_violation(&moments);
    state.unfamiliar.add(&moments);
    if command.stream().tracks.are_live()
        && let Some(warning) = state.unfamiliar.warning()
    {
        tell(format_args!("{}; this warning appears once, but each forecast has its familiarity", warning.line()));
    }
    make(&moments, state)
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
    pub(super) fn warn_of_flood(&self, lines: usize, bytes: usize, moments: usize) {
        let on_terminal = file_of(self.output.as_deref()).is_none() && std::io::stdout().is_terminal();
        if on_terminal && lines > LOOKED_THROUGH {
            tell(format_args!(
                "note: {lines} lines; --output FILE writes them to a file, --last gives those of the last frame \
                 alone, `ddl view` shows forecasts"
            ));
        } else if bytes > LARGE && moments > 1 {
            tell(format_args!(
                "note: {} MiB, because all pedestrians are forecast from every frame; --last takes the last alone",
                bytes >> 20
            ));
        }
    }
}
