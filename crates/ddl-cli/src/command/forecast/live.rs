//! `ddl forecast -`: reads tracks from standard input and forecasts every frame.

use crate::command::forecast::first_rows::FirstRows;
use crate::command::forecast::frames::{Incoming, IncomingFrames, StatedTime};
use crate::command::forecast::kept_memory::KeptMemory;
use crate::command::forecast::left_out::LeftOut;
use crate::command::forecast::moment::{SceneWindows, StreamState};
use crate::command::forecast::stream::{Answer, StreamOptions, text_of};
use crate::interrupt::Interrupt;
use crate::output::file_of;
use crate::telling::{tell, words};
use crate::units::Units;
use anyhow::{Context as _, bail};
use ddl::data::{Clock, Frame, Homography, LiveTracks, Observation, SceneName, Window};
use ddl::{Ddl, LiveScenes, steps_in_words};
use std::fs::File;
use std::io::{Write as _, stdout};
use std::path::Path;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Largest difference of frame numbers that is taken for a step of 0.4 s. A larger one may be a gap, or timestamps.
const LONGEST_STEP: i64 = 1000;

/// Number of waiting windows at which reading stops, if every frame is forecast.
const MOST_WAITING: usize = 64;
/// Number of rows after which a stream is told that few are forecast.
const MANY_ROWS: usize = 500;
/// Number of frames before that message: a forecast needs two rows of a pedestrian, and the first frame has one.
const SEVERAL_FRAMES: usize = 10;
/// Largest number of frames read between two batches, if only the latest frame of each scene is forecast.
const MOST_TAKEN: usize = 4096;

/// Forecasts every frame as soon as it is complete, until standard input ends or the reader closes the output.
pub(super) fn run(command: &dyn Answer) -> anyhow::Result<()> {
    let model = command.stream().load()?;
    let memory = command.stream().memory.as_deref();
    let watching =
        WatchedStream { scenes: None, memory: memory.map(|path| KeptMemory::open(path, &model)).transpose()? };
    let watching = Arc::new(Mutex::new(watching));
    if memory.is_some() {
        // After Ctrl-C, the thread of the handler writes the memory.
        let of_handler = Arc::clone(&watching);
        Interrupt::catch_until(2, move |_| {
            if let Err(error) = lock(&of_handler).end() {
                tell(format_args!("error: {}", words(&error)));
            }
            std::process::exit(130);
        })?;
    }
    let answered = answer(command, &model, &watching);
    // The memory is also written if the stream ended with an error.
    let written = lock(&watching).end();
    if let (Err(_), Err(error)) = (&answered, &written) {
        tell(format_args!("error: {}", words(error)));
    }
    answered.and(written)
}

fn answer(command: &dyn Answer, model: &Ddl, watching: &Mutex<WatchedStream>) -> anyhow::Result<()> {
    let forecast = command.stream();
    let units = forecast.tracks.live_units(model.config())?;
    let homography = units.homography()?;
    if let Some(note) = units.note_of_run(false) {
        tell(format_args!("note: {note}"));
    }
    let clock = units.live_clock()?;
    if let Some(clock) = clock {
        begin(forecast, model, watching, clock)?;
    }
    let mut stream = Stream {
        command,
        forecast,
        model,
        watching,
        homography,
        clock,
        early: Vec::new(),
        output: ForecastOutput::open(forecast.output.as_deref())?,
        state: StreamState::default(),
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
    stream.left_out.end(stream.answered, lock(watching).scenes.as_ref())?;
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

/// Creates the scenes, as soon as the clock is known.
fn begin(forecast: &StreamOptions, model: &Ddl, watching: &Mutex<WatchedStream>, clock: Clock) -> anyhow::Result<()> {
    let scenes = LiveScenes::new(forecast.tracks.windows_of(LiveTracks::with_clock(clock)));
    let scenes = if forecast.latest { scenes.latest_only() } else { scenes };
    let mut watching = lock(watching);
    let WatchedStream { scenes: to, memory } = &mut *watching;
    let scenes = to.insert(scenes);
    match memory {
        // Without scene names there is one memory file: its errors are reported before the first frame.
        Some(memory) => memory.begin(None, scenes, model),
        None => Ok(()),
    }
}

/// The scenes of the stream, and their memories.
struct WatchedStream {
    /// `None` until the clock is known.
    scenes: Option<LiveScenes>,
    memory: Option<KeptMemory>,
}

/// Ignores a panic of the other thread: scenes and memories are consistent after every call.
fn lock(watching: &Mutex<WatchedStream>) -> MutexGuard<'_, WatchedStream> {
    watching.lock().unwrap_or_else(PoisonError::into_inner)
}

impl WatchedStream {
    /// Ends the scenes that have been idle, when another one begins.
    fn forget_idle(&mut self) -> (Vec<SceneName>, anyhow::Result<()>) {
        let Some(scenes) = &mut self.scenes else {
            return (Vec::new(), Ok(()));
        };
        let (idle, mut ended) = (scenes.idle(), Ok(()));
        for scene in &idle {
            if let Some(memory) = &mut self.memory {
                ended = ended.and(memory.end(Some(scene), scenes));
            }
            scenes.forget(Some(scene));
        }
        (idle, ended)
    }

    fn observe(&mut self, frame: Frame, model: &Ddl) -> anyhow::Result<()> {
        let Some(scenes) = &mut self.scenes else {
            return Ok(());
        };
        let Some(memory) = &mut self.memory else {
            return Ok(scenes.observe_frame(frame)?);
        };
        let name = frame.scene.clone();
        // A scene whose memory cannot be used is forecast without memory.
        let begun = memory.begin(name.as_ref(), scenes, model);
        scenes.observe_frame(frame)?;
        memory.tell_refusal(name.as_ref(), scenes);
        begun
    }

    fn write_when_due(&mut self) {
        if let (Some(memory), Some(scenes)) = (&mut self.memory, &self.scenes) {
            memory.write_when_due(scenes);
        }
    }

    fn end(&mut self) -> anyhow::Result<()> {
        match (&mut self.memory, &mut self.scenes) {
            (Some(memory), Some(scenes)) => memory.end_all(scenes),
            _ => Ok(()),
        }
    }
}

struct Stream<'a> {
    command: &'a dyn Answer,
    forecast: &'a StreamOptions,
    model: &'a Ddl,
    watching: &'a Mutex<WatchedStream>,
    homography: Option<Homography>,
    /// `None` until it is known.
    clock: Option<Clock>,
    /// The first frame of each scene, until the clock is known.
    early: Vec<Frame>,
    output: ForecastOutput,
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
            let waiting = self.waiting();
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
        while self.waiting() > 0 {
            self.answer_batch()?;
        }
        wrong.map_or(Ok(()), Err)
    }

    fn waiting(&self) -> usize {
        let watching = lock(self.watching);
        watching.scenes.as_ref().map_or(0, LiveScenes::waiting)
    }

    fn take(&mut self, frame: Frame, stated: &StatedTime, units: &Units) -> anyhow::Result<()> {
        for note in &stated.notes {
            tell(format_args!("note: {note}"));
        }
        if std::mem::take(&mut self.is_empty)
            && let Some(memory) = &lock(self.watching).memory
        {
            memory.ensure_fits(frame.scene.as_ref())?;
        }
        self.state.tell_other_rate(units, stated);
        self.taken += 1;
        if self.clock.is_none() {
            let mut early = self.early.iter();
            let first = early.find(|early| early.scene == frame.scene);
            let apart = first.map(|first| frame.number - first.number);
            let Some((clock, reason)) = clock_of(units, apart, stated)? else {
                self.early.push(frame);
                return Ok(());
            };
            if let Some(reason) = reason {
                tell(format_args!(
                    "note: a step of 0.4 s is taken as {}, {reason}; give --fps or --frame-step if this is wrong",
                    steps_in_words(clock)
                ));
            }
            begin(self.forecast, self.model, self.watching, clock)?;
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
        let (idle, ended) = if frame.is_first { watching.forget_idle() } else { (Vec::new(), Ok(())) };
        for scene in idle {
            self.state.forget(&scene);
        }
        let (scene, rows) = (frame.scene.clone(), frame.pedestrians.len());
        let names = frame.names.clone();
        let is_watched = self.first_rows.watches(&scene);
        let pedestrians = is_watched.then(|| frame.pedestrians.clone());
        let observed = watching.observe(frame, self.model);
        let scenes = watching.scenes.as_ref();
        let tracks = scenes.and_then(|scenes| scenes.tracks(scene.as_ref()));
        if let (true, Some(tracks)) = (observed.is_ok(), tracks) {
            if let Some(pedestrians) = pedestrians {
                self.first_rows.add(&scene, tracks, &pedestrians);
            }
            let place = scene.map_or_else(String::new, |scene| format!(" of scene {scene}"));
            self.left_out.doubtful(rows, tracks.misfits(), |misfit| {
                let name = names.of(misfit.pedestrian);
                format!("pedestrian {name}{place} at {}", tracks.clock().words(misfit.tick))
            });
            self.observed += 1;
            self.state.tell_doubts(tracks, self.observed, self.forecast.tracks.are_thinned());
            let is_idle = watching.scenes.as_ref().is_some_and(|scenes| scenes.waiting() == 0);
            if is_idle && !self.forecast.latest && !self.forecast.tracks.are_thinned() {
                self.left_out.tell_if_few(MANY_ROWS, SEVERAL_FRAMES);
            }
        }
        observed.and(ended)
    }

    fn answer_batch(&mut self) -> anyhow::Result<()> {
        self.taken = 0;
        let batch = {
            let mut watching = lock(self.watching);
            watching.write_when_due();
            let Some(scenes) = &mut watching.scenes else {
                return Ok(());
            };
            self.left_out.dropped(scenes);
            scenes.next_batch(LiveScenes::BATCH)
        };
        for (window, scene) in batch.windows.iter().zip(&batch.scenes) {
            if self.first_rows.watches(scene) && (0..window.len()).any(|i| window.quality(i).is_whole()) {
                self.first_rows.warn_if_fast(scene);
            }
        }
        match self.text(&batch.windows, &batch.scenes) {
            Ok(text) => return self.write(&text, &batch.windows),
            // The error does not name its window, so the windows are forecast one by one.
            Err(_) if batch.windows.len() > 1 => {}
            Err(error) => return self.failed(error, batch.scenes.iter().any(Option::is_some)),
        }
        for (window, scene) in batch.windows.iter().zip(&batch.scenes) {
            let one = (std::slice::from_ref(window), std::slice::from_ref(scene));
            match self.text(one.0, one.1) {
                Ok(text) => self.write(&text, one.0)?,
                Err(error) => self.failed(error, scene.is_some())?,
            }
        }
        Ok(())
    }

    fn text(&mut self, windows: &[Window], scenes: &[Option<SceneName>]) -> anyhow::Result<String> {
        let windows = SceneWindows { windows, scenes };
        let clock = self.clock.unwrap_or(Clock::STEPS);
        text_of(self.command, self.model, windows, clock, &mut self.state)
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

struct ForecastOutput {
    /// `None` for standard output.
    file: Option<File>,
    /// Whether a forecast was written. The first forecast replaces an existing file; an input without forecasts does
    /// not.
    begun: bool,
}

impl ForecastOutput {
    /// Opens the output before the first forecast, so that an error shows at once.
    fn open(path: Option<&Path>) -> anyhow::Result<Self> {
        let mut options = File::options();
        let options = options.write(true).create(true).truncate(false);
        let open = |path: &Path| {
            let file = options.open(path);
            file.with_context(|| format!("cannot write {}", path.display()))
        };
        Ok(Self { file: file_of(path).map(open).transpose()?, begun: false })
    }

    fn write(&mut self, text: &str) -> std::io::Result<()> {
        let Some(file) = &mut self.file else {
            let mut out = stdout().lock();
            out.write_all(text.as_bytes())?;
            return out.flush();
        };
        // A device or a pipe has no earlier content.
        if !self.begun && file.metadata()?.is_file() {
            file.set_len(0)?;
        }
        self.begun = true;
        file.write_all(text.as_bytes())
    }
}

fn to_ground(mut frame: Frame, homography: Option<&Homography>) -> anyhow::Result<Frame> {
    let Some(homography) = homography else {
        return Ok(frame);
    };
    for (pedestrian, position) in &mut frame.pedestrians {
        let seen = Observation::new(frame.number, *pedestrian, *position);
        *position = homography.place(&seen, &frame.names).context("standard input")?;
    }
    Ok(frame)
}

/// The clock if no option gives it, and the reason if it is assumed; `None` if it needs another frame.
///
/// `apart`: difference of the first two frame numbers of a scene.
fn clock_of(units: &Units, apart: Option<i64>, stated: &StatedTime) -> anyhow::Result<Option<(Clock, Option<String>)>> {
    if let Some(unit) = stated.time_unit {
        return Ok(Some((Clock::with_stamps(unit), None)));
    }
    if let Some(rate) = stated.frame_rate {
        let clock = Clock::with_frame_time(1.0 / rate).context("standard input: the rate of a comment")?;
        return Ok(Some((clock, Some(format!("at {rate} frames a second")))));
    }
    let Some(apart) = apart else {
        return Ok(None);
    };
    if let Some(rate) = stated.rows_a_second {
        let clock = Clock::with_frame_time(1.0 / (rate * apart as f64)).with_context(|| {
            format!(
                "standard input: the scenes give {rate} frames per second, but the first two frames are {apart} apart"
            )
        })?;
        return Ok(Some((clock, Some(format!("from the fps of the scenes, {rate}")))));
    }
    if let Some((clock, reason)) = units.remembered_live_clock()? {
        return Ok(Some((clock, Some(reason))));
    }
    if apart > LONGEST_STEP {
        bail!(
            "standard input: the first two frames are {apart} apart; give the number of frames in 0.4 s with --fps or \
             --frame-step"
        );
    }
    let clock = Clock::with_frame_step(apart)?;
    Ok(Some((clock, Some("the difference of the first two frames".to_owned()))))
}
