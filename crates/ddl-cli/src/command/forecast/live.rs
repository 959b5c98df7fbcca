//! `ddl forecast -`: reads tracks from standard input and forecasts every frame.

use crate::command::forecast::first_rows::FirstRows;
use crate::command::forecast::frames::{Incoming, IncomingFrames, StatedTime, to_ground};
use crate::command::forecast::left_out::LeftOut;
use crate::command::forecast::state::StreamState;
use crate::command::forecast::stream::{AnsweringCommand, StreamOptions, answers_of};
use crate::interrupt::Interrupt;
use crate::output::StreamOutput;
use crate::telling::{tell, tell_note, words};
use crate::units::Units;
use anyhow::{Context as _, bail};
use ddl::data::{Clock, Frame, Homography, LiveTracks, SceneName, Window};
use ddl::{Ddl, Moment, Note, Request, SceneBatch, SceneWindows, Session, SessionMemory, steps_in_words};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Number of waiting windows at which reading stops, if every frame is forecast.
const MOST_WAITING: usize = 64;
/// Number of rows after which a stream is told that few are forecast.
const MANY_ROWS: usize = 500;
/// Number of frames before that message: a forecast needs two rows of a pedestrian, and the first frame has one.
const SEVERAL_FRAMES: usize = 10;
/// Largest number of frames read between two batches, if only the latest frame of each scene is forecast.
const MOST_TAKEN: usize = 4096;

/// Forecasts every frame as soon as it is complete, until standard input ends or the reader closes the output.
pub(super) fn run(command: &dyn AnsweringCommand, state: StreamState) -> anyhow::Result<()> {
    let model = command.stream().load()?;
    let memory = match command.stream().memory.as_deref() {
        Some(path) => {
            model.goal_model().recalled_per_pedestrian()?;
            Some(SessionMemory::at(path)?)
        }
        None => None,
    };
    let is_remembering = memory.is_some();
    let watching = Arc::new(Mutex::new(WatchedStream { session: None, memory }));
    if is_remembering {
        // After Ctrl-C, the thread of the handler writes the memory.
        let of_handler = Arc::clone(&watching);
        Interrupt::catch_until(2, move |_| {
            if let Err(error) = lock(&of_handler).end() {
                tell(format_args!("error: {}", words(&error)));
            }
            std::process::exit(130);
        })?;
    }
    let answered = answer(command, state, &Arc::new(model), &watching);
    // The memory is also written if the stream ended with an error.
    let written = lock(&watching).end();
    if let (Err(_), Err(error)) = (&answered, &written) {
        tell(format_args!("error: {}", words(error)));
    }
    answered.and(written)
}

fn answer(
    command: &dyn AnsweringCommand,
    state: StreamState,
    model: &Arc<Ddl>,
    watching: &Mutex<WatchedStream>,
) -> anyhow::Result<()> {
    let forecast = command.stream();
    let units = forecast.tracks.live_units(model.config())?;
    let homography = units.homography()?;
    if let Some(note) = units.note_of_run(false) {
        tell(format_args!("note: {note}"));
    }
    let clock = units.live_clock()?;
    if let Some(clock) = clock {
        lock(watching).begin(forecast, model, clock)?;
    }
    let mut stream = Stream {
        command,
        forecast,
        model,
        watching,
        homography,
        clock,
        early: Vec::new(),
        output: StreamOutput::open(forecast.output.as_deref())?,
        state,
        left_out: LeftOut::default(),
        is_empty: true,
        first_rows: FirstRows::default(),
        observed: 0,
        taken: 0,
        answered: 0,
    };
    let choice = units.choice(stream.homography.is_some())?;
    let followed = stream.follow(&IncomingFrames::of_standard_input(choice)?, &units);
    stream.first_rows.warn();
    followed?;
    if !forecast.latest && !forecast.tracks.are_thinned() {
        stream.left_out.tell_if_few(1, 1);
    }
    let waiting = lock(watching).session.as_ref().map(|session| session.waiting().clone());
    stream.left_out.end(stream.answered, waiting.as_ref())?;
    if stream.is_empty {
        bail!(
            "standard input holds no tracks, or only rows that are left out (vehicles, lost positions, the pedestrian \
             -1): the first line must be frame,pedestrian,x,y, followed by a row for each pedestrian and frame"
        );
    }
    if !stream.state.headed {
        bail!(
            "standard input: no pedestrian was observed long enough to be forecast; give --unit or --homography if \
             positions are not in metres, and check --fps or --frame-step of frame numbers"
        );
    }
    Ok(())
}

/// The scenes of the stream, and where their memories are.
struct WatchedStream {
    /// `None` until the clock is known.
    session: Option<Session<Arc<Ddl>>>,
    /// Until the session has it.
    memory: Option<SessionMemory>,
}

/// Ignores a panic of the other thread: the session is consistent after every call.
fn lock(watching: &Mutex<WatchedStream>) -> MutexGuard<'_, WatchedStream> {
    watching.lock().unwrap_or_else(PoisonError::into_inner)
}

impl WatchedStream {
    /// Begins the session, as soon as the clock is known. Without scene names there is one memory file: its errors are
    /// reported before the first frame.
    fn begin(&mut self, forecast: &StreamOptions, model: &Arc<Ddl>, clock: Clock) -> anyhow::Result<()> {
        let tracks = forecast.tracks.windows().tracks(LiveTracks::with_clock(clock))?;
        let session = Session::new(Arc::clone(model), tracks, Request::default())?;
        let session = session.remembering(self.memory.take().unwrap_or_default())?;
        self.session = Some(if forecast.latest { session.latest_only() } else { session });
        Ok(())
    }

    /// Refuses a memory of one place for a stream of several scenes, and one of several for a stream of one.
    fn ensure_memory_fits(&self, scene: Option<&SceneName>) -> anyhow::Result<()> {
        let memory = self.memory.as_ref().or(self.session.as_ref().map(Session::memory));
        memory.map_or(Ok(()), |memory| memory.ensure_fits(scene)).context("--memory")
    }

    /// Number of windows that wait for an answer.
    fn waiting(&self) -> usize {
        self.session.as_ref().map_or(0, |session| session.waiting().count())
    }

    /// Writes the memories; the first error of several is returned.
    fn end(&mut self) -> anyhow::Result<()> {
        let notes = self.session.as_mut().map(Session::close).unwrap_or_default();
        let mut failed = None;
        for note in notes {
            match note {
                Note::MemoryFailed(error) if failed.is_none() => failed = Some(error),
                Note::MemoryUnsaved { is_refusal_told: true, .. } => {}
                note => tell_note(&note),
            }
        }
        failed.map_or(Ok(()), |error| Err(error.into()))
    }
}

struct Stream<'a> {
    command: &'a dyn AnsweringCommand,
    forecast: &'a StreamOptions,
    model: &'a Arc<Ddl>,
    watching: &'a Mutex<WatchedStream>,
    homography: Option<Homography>,
    /// `None` until it is known.
    clock: Option<Clock>,
    /// The first frame of each scene, until the clock is known.
    early: Vec<Frame>,
    output: StreamOutput,
    state: StreamState,
    left_out: LeftOut,
    is_empty: bool,
    first_rows: FirstRows,
    /// Number of frames of tracks.
    observed: u64,
    /// Number of frames read since the last batch.
    taken: usize,
    /// Number of frames whose forecasts were written.
    answered: u64,
}

impl Stream<'_> {
    /// Reads all frames that have arrived, then forecasts a batch. It blocks for input only if no window waits for a
    /// forecast.
    fn follow(&mut self, frames: &IncomingFrames, units: &Units) -> anyhow::Result<()> {
        let wrong = loop {
            let waiting = lock(self.watching).waiting();
            let is_full = if self.forecast.latest {
                self.taken >= MOST_TAKEN && waiting > 0
            } else {
                waiting >= MOST_WAITING.min(self.command.at_once())
            };
            let incoming = match waiting {
                0 => match frames.wait() {
                    None => break None,
                    incoming => incoming,
                },
                _ if is_full => None,
                _ => frames.come(),
            };
            match incoming {
                None => self.answer_batch()?,
                Some(Incoming::Frame(frame, stated)) => {
                    if let Err(error) = self.take(frame, &stated, units) {
                        break Some(error);
                    }
                }
                Some(Incoming::Wrong(error)) => self.left_out.wrong(&error.into()),
                Some(Incoming::End(error)) => break Some(error.into()),
            }
        };
        // Frames before the invalid line are still forecast.
        while lock(self.watching).waiting() > 0 {
            self.answer_batch()?;
        }
        wrong.map_or(Ok(()), Err)
    }

    fn take(&mut self, frame: Frame, stated: &StatedTime, units: &Units) -> anyhow::Result<()> {
        for note in &stated.notes {
            tell(format_args!("note: {note}"));
        }
        if std::mem::take(&mut self.is_empty) {
            lock(self.watching).ensure_memory_fits(frame.scene.as_ref())?;
        }
        self.state.tell_other_rate(units, stated);
        self.taken += 1;
        if self.clock.is_none() {
            let mut early = self.early.iter();
            let first = early.find(|early| early.scene == frame.scene);
            let apart = first.map(|first| frame.number - first.number);
            let Some((clock, reason)) = stated.clock(units, apart)? else {
                self.early.push(frame);
                return Ok(());
            };
            if let Some(reason) = reason {
                tell(format_args!(
                    "note: a step of 0.4 s is taken as {}, {reason}; give --fps or --frame-step if this is wrong",
                    steps_in_words(clock)
                ));
            }
            lock(self.watching).begin(self.forecast, self.model, clock)?;
            self.clock = Some(clock);
        }
        if let (Some(option), Some(_)) = (units.rate_given(), stated.time_unit) {
            bail!("standard input: the rows have times, and {option} gives a rate: leave it out");
        }
        let early = std::mem::take(&mut self.early).into_iter();
        for frame in early.chain([frame]) {
            let is_named = frame.scene.is_some();
            match self.observe(frame) {
                // The other scenes continue.
                Err(error) if is_named => self.left_out.wrong(&error),
                observed => observed?,
            }
        }
        Ok(())
    }

    fn observe(&mut self, frame: Frame) -> anyhow::Result<()> {
        let frame = to_ground(frame, self.homography.as_ref())?;
        let mut watching = lock(self.watching);
        let Some(session) = &mut watching.session else {
            return Ok(());
        };
        let scene = frame.scene.as_ref();
        let mut notes = if frame.is_first { session.begin_again(scene) } else { Vec::new() };
        let observed = session.observe(scene, frame.number, frame.pedestrians.iter().copied(), &frame.names);
        let (seen, failed) = match observed {
            Ok(seen) => (Some(seen), None),
            Err(error) => (None, Some(error)),
        };
        let tracks = seen.as_ref().and_then(|_| session.tracks(scene));
        notes.extend(seen.into_iter().flatten());
        if let Some(tracks) = tracks {
            if self.first_rows.watches(&frame.scene) {
                self.first_rows.add(&frame.scene, tracks, &frame.pedestrians);
            }
            let misfits = notes.iter().map(Note::misfits).find(|misfits| !misfits.is_empty());
            self.left_out.doubtful(frame.pedestrians.len(), scene, misfits.unwrap_or_default());
            self.observed += 1;
            self.state.tell_doubts(tracks, self.observed, self.forecast.tracks.are_thinned());
            let is_idle = session.waiting().count() == 0;
            if is_idle && !self.forecast.latest && !self.forecast.tracks.are_thinned() {
                self.left_out.tell_if_few(MANY_ROWS, SEVERAL_FRAMES);
            }
        }
        for note in notes {
            match note {
                Note::Misfits { .. } | Note::MemoryUnsaved { is_refusal_told: true, .. } => {}
                // The scenes go on.
                Note::MemoryFailed(error) => self.left_out.wrong(&error.into()),
                note => tell_note(&note),
            }
        }
        failed.map_or(Ok(()), |error| Err(error.into()))
    }

    fn answer_batch(&mut self) -> anyhow::Result<()> {
        self.taken = 0;
        let batch = {
            let mut watching = lock(self.watching);
            let Some(session) = &mut watching.session else {
                return Ok(());
            };
            session.write_due().iter().for_each(tell_note);
            self.left_out.dropped(session.waiting());
            session.next_batch(SceneBatch::PEDESTRIANS)
        };
        for (window, scene) in batch.windows.iter().zip(&batch.scenes) {
            if self.first_rows.watches(scene) && (0..window.len()).any(|i| window.quality(i).is_whole()) {
                self.first_rows.warn_if_fast(scene);
            }
        }
        match self.text(batch.windows()) {
            Ok(text) => return self.write(&text, &batch.windows),
            // The error does not name its window, so the windows are forecast one by one.
            Err(_) if batch.windows.len() > 1 => {}
            Err(error) => return self.failed(error, batch.scenes.iter().any(Option::is_some)),
        }
        for one in batch.each() {
            match self.text(one.windows()) {
                Ok(text) => self.write(&text, &one.windows)?,
                Err(error) => self.failed(error, one.scenes.iter().any(Option::is_some))?,
            }
        }
        Ok(())
    }

    fn text(&mut self, windows: SceneWindows<'_>) -> anyhow::Result<String> {
        let clock = self.clock.unwrap_or(Clock::STEPS);
        let (command, model, watching) = (self.command, self.model, self.watching);
        // The session is free while the model works: after Ctrl-C it writes its memories.
        let answer = |windows: SceneWindows<'_>, request: Request| {
            let mut plain = request.clone();
            plain.adaptive_regions = false;
            let answers = model.forecast(windows.windows, &plain)?;
            match &mut lock(watching).session {
                Some(session) => {
                    session.ask(request)?;
                    Ok(session.adapt(windows, answers))
                }
                None => Ok(answers),
            }
        };
        let text = |moments: &[Moment<'_>], state: &mut StreamState| command.text(moments, state);
        answers_of(command, windows, clock, &mut self.state, answer, text)
    }

    /// Leaves out a failed forecast of a named scene. Before the first forecast it is an error, because the arguments
    /// are probably wrong.
    fn failed(&mut self, error: anyhow::Error, is_named: bool) -> anyhow::Result<()> {
        if !is_named || self.answered == 0 {
            return Err(error);
        }
        self.left_out.wrong(&error);
        Ok(())
    }

    fn write(&mut self, text: &str, windows: &[Window]) -> anyhow::Result<()> {
        let frames = windows.len();
        self.left_out.forecast(windows.iter().map(Window::len).sum());
        self.answered += frames as u64;
        self.output.write(text).with_context(|| match &self.forecast.output {
            Some(path) => format!(
                "cannot write on to {0}, which holds the forecasts so far (another run with --output {0} replaces \
                     them)",
                path.display()
            ),
            None => "cannot write to standard output".to_owned(),
        })
    }
}
