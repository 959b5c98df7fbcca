//! Answers to every moment of a file of tracks or of live tracks.

use crate::command::forecast::live;
use crate::command::forecast::state::StreamState;
use crate::command::forecast::stream::{AnsweringCommand, answers_of};
use crate::interrupt::Interrupt;
use crate::output::{write_file, write_parts};
use crate::telling::{tell, tell_note};
use anyhow::bail;
use ddl::data::{LiveTracks, Window};
use ddl::{DdlError, Moment, Request, SceneWindows, Session};
use ddl_mcap::ForecastLog;

/// Answers every moment of the tracks; `state` is that before the first.
pub(crate) fn answer(command: &dyn AnsweringCommand, mut state: StreamState) -> anyhow::Result<()> {
    let stream = command.stream();
    stream.machine.prepare_for_little()?;
    if stream.memory.is_some() && !stream.tracks.are_live() {
        bail!(
            "--memory is for live tracks from standard input (`ddl forecast - --memory FILE`): give `-` for the file"
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
        return live::run(command, state);
    }
    let model = stream.load()?;
    let (observed, topic) = stream.tracks.observed(model.config())?;
    state.frame_id = topic.as_ref().and_then(|topic| topic.frame_id.clone());
    let (mut lines, mut bytes) = (0, 0);
    let interrupt = Interrupt::catch()?;
    let mut session = Session::new(&model, LiveTracks::new(), Request::default())?;
    let mut ask = |windows: SceneWindows<'_>, request: Request| {
        session.ask(request)?;
        Ok(session.answer(windows)?)
    };
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
                answers_of(command, windows?, observed.clock, &mut state, &mut ask, add)?;
            }
            Ok(log.finish()?)
        })?;
    } else {
        let texts = parts.map(|windows| {
            let make = |moments: &[Moment<'_>], state: &mut StreamState| command.text(moments, state);
            let text = answers_of(command, windows?, observed.clock, &mut state, &mut ask, make)?;
            bytes += text.len();
            lines += text.lines().count();
            Ok(text)
        });
        write_parts(stream.output.as_deref(), texts)?;
    }
    state.unfamiliar.warning().iter().for_each(tell_note);
    stream.warn_of_flood(lines, bytes, observed.windows.len());
    observed.estimated().iter().for_each(tell_note);
    Ok(())
}
