//! `ddl forecast -`: reads tracks from standard input and forecasts every frame.

use crate::clock::Clock;
use crate::command::forecast::arguments::ForecastCommand;
use crate::command::forecast::frames::{Incoming, IncomingFrames};
use crate::command::forecast::kept_memory::KeptMemory;
use crate::command::forecast::left_out::LeftOut;
use crate::command::forecast::moment::{SceneWindows, StreamState};
use crate::interrupt::Interrupt;
use crate::recordings;
use crate::telling::{tell, words};
use crate::units::{Units, live_step};
use anyhow::{Context as _, bail};
use ddl::data::{
    CompletionCounts, Frame, Homography, LiveTracks, Observation, PlausibilityWarning, Recording, SceneName, Window,
};
use ddl::{Ddl, LiveScenes};
use std::fs::File;
use std::io::{Write as _, stdout};
use std::path::Path;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Largest difference of frame numbers that is taken for a step of 0.4 s. A larger one may be a gap, or timestamps.
const LONGEST_STEP: i64 = 1000;

/// Number of waiting windows at which reading stops, if every frame is forecast.
const MOST_WAITING: usize = 64;
/// Largest number of frames read between two batches, if only the latest frame of each scene is forecast.
const MOST_TAKEN: usize = 4096;

/// Forecasts every frame as soon as it is complete, until standard input ends or the reader closes the output.
pub(super) fn run(forecast: &ForecastCommand) -> anyhow::Result<()> {
    let model = forecast.model()?;
    let memory = forecast.memory.as_deref();
    let watching = WatchedStream {
        scenes: None,
        memory: memory.map(|path| KeptMemory::open(path, &model)).transpose()?,
    };
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
    let answered = answer(forecast, &model, &watching);
    // The memory is also written if the stream ended with an error.
    let written = lock(&watching).end();
    if let (Err(_), Err(error)) = (&answered, &written) {
        tell(format_args!("error: {}", words(error)));
    }
    answered.and(written)
}

fn answer(forecast: &ForecastCommand, model: &Ddl, watching: &Mutex<WatchedStream>) -> anyhow::Result<()> {
    let units = forecast.tracks.live_units(model.config())?;
    let homography = units.homography()?;
    if let Some(note) = units.note_of_run(false) {
        tell(format_args!("note: {note}"));
    }
    if let Some(step) = units.live_frame_step()? {
        begin(forecast, model, watching, step)?;
    }
    let mut stream = Stream {
        forecast,
        model,
        watching,
        homography,
        early: Vec::new(),
        output: ForecastOutput::open(forecast.output.as_deref())?,
        state: StreamState::default(),
        left_out: LeftOut::default(),
        is_empty: true,
        looked_at: false,
        taken: 0,
        answered: 0,
    };
    stream.follow(&IncomingFrames::of_standard_input()?, &units)?;
    stream.left_out.end(stream.answered, lock(watching).scenes.as_ref())?;
    if stream.is_empty {
        bail!(
            "standard input holds no tracks: the first line must be frame,pedestrian,x,y, followed by a row for each \
             pedestrian and frame"
        );
    }
    if !stream.state.headed {
        bail!(
            "standard input: no pedestrian was observed long enough to be forecast; give --fps or --frame-step if \
                 frame numbers are not 0.4 s apart"
        );
    }
    Ok(())
}

/// Creates the scenes, as soon as the frame step is known.
fn begin(forecast: &ForecastCommand, model: &Ddl, watching: &Mutex<WatchedStream>, step: i64) -> anyhow::Result<()> {
    let tracks = LiveTracks::with_frame_step(step)?.with_completion(forecast.tracks.completion());
    let scenes = LiveScenes::new(tracks);
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
    /// `None` until the frame step is known.
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
    forecast: &'a ForecastCommand,
    model: &'a Ddl,
    watching: &'a Mutex<WatchedStream>,
    homography: Option<Homography>,
    /// The first frame of each scene, until the frame step is known.
    early: Vec<Frame>,
    output: ForecastOutput,
    state: StreamState,
    left_out: LeftOut,
    is_empty: bool,
    /// Whether the speeds of the first pedestrians have been checked.
    looked_at: bool,
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
                waiting >= MOST_WAITING
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
                Some(Incoming::Frame(frame, rate)) => {
                    if let Err(error) = self.take(frame, rate, units) {
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

    /// Adds a frame. `rate`: frames per second, if the input states it.
    fn take(&mut self, frame: Frame, rate: Option<f64>, units: &Units) -> anyhow::Result<()> {
        if std::mem::take(&mut self.is_empty)
            && let Some(memory) = &lock(self.watching).memory
        {
            memory.ensure_fits(frame.scene.as_ref())?;
        }
        self.taken += 1;
        if lock(self.watching).scenes.is_none() {
            let mut early = self.early.iter();
            let Some(first) = early.find(|early| early.scene == frame.scene) else {
                self.early.push(frame);
                return Ok(());
            };
            let (step, reason) = step(units, frame.number - first.number, rate)?;
            tell(format_args!(
                "note: frame numbers are assumed to be {step} apart in 0.4 s, {reason}; give --fps or --frame-step if \
                 this is wrong"
            ));
            begin(self.forecast, self.model, self.watching, step)?;
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
        let (idle, ended) = if frame.is_first {
            watching.forget_idle()
        } else {
            (Vec::new(), Ok(()))
        };
        for scene in idle {
            self.state.forget(&scene);
        }
        watching.observe(frame, self.model).and(ended)
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
        for window in &batch.windows {
            if !self.looked_at {
                self.looked_at = warn_of_speeds(window)?;
            }
        }
        match self.text(&batch.windows, &batch.scenes) {
            Ok(text) => return self.write(&text, batch.windows.len()),
            // The error does not name its window, so the windows are forecast one by one.
            Err(_) if batch.windows.len() > 1 => {}
            Err(error) => return self.failed(error, batch.scenes.iter().any(Option::is_some)),
        }
        for (window, scene) in batch.windows.iter().zip(&batch.scenes) {
            let one = (std::slice::from_ref(window), std::slice::from_ref(scene));
            match self.text(one.0, one.1) {
                Ok(text) => self.write(&text, 1)?,
                Err(error) => self.failed(error, scene.is_some())?,
            }
        }
        Ok(())
    }

    fn text(&mut self, windows: &[Window], scenes: &[Option<SceneName>]) -> anyhow::Result<String> {
        let windows = SceneWindows { windows, scenes };
        self.forecast.text(self.model, windows, Clock::WHOLE, &mut self.state)
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

    fn write(&mut self, text: &str, frames: usize) -> anyhow::Result<()> {
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
        Ok(Self {
            file: path.map(open).transpose()?,
            begun: false,
        })
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

/// Warns if the speeds in the first complete window look wrong; returns whether it warned.
fn warn_of_speeds(window: &Window) -> anyhow::Result<bool> {
    let whole = (0..window.len()).filter(|&i| window.completion_counts(i) == CompletionCounts::default());
    let seen: Vec<Observation> = whole
        .flat_map(|i| {
            let pedestrian = window.pedestrians()[i];
            let places = window.frames().iter().zip(window.observed(i));
            places.map(move |(&frame, &place)| Observation::new(frame, pedestrian, place))
        })
        .collect();
    if seen.is_empty() {
        return Ok(false);
    }
    let recording = Recording::new("standard input", window.frame_step(), seen)?;
    // Other warnings are left out: a jump does not point to wrong units, and a pedestrian may be slow for 3.2 s.
    if let Some(warning @ PlausibilityWarning::Fast { .. }) = &recording.speed_warning() {
        recordings::warn_of(warning);
    }
    Ok(true)
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

/// The frame step if no option gives it, with the reason. `apart`: difference of the first two frame numbers.
fn step(units: &Units, apart: i64, rate: Option<f64>) -> anyhow::Result<(i64, String)> {
    if let Some(rate) = rate {
        let step = live_step(1.0 / (rate * apart as f64)).with_context(|| {
            format!(
                "standard input: the scenes give {rate} frames per second, but the first two frames are {apart} apart"
            )
        })?;
        return Ok((step, format!("from the fps of the scenes, {rate}")));
    }
    if let Some(remembered) = units.remembered_live_frame_step()? {
        return Ok(remembered);
    }
    if apart > LONGEST_STEP {
        bail!(
            "standard input: the first two frames are {apart} apart; give the number of frames in 0.4 s with --fps or \
             --frame-step"
        );
    }
    Ok((apart, "the difference of the first two frames".to_owned()))
}
