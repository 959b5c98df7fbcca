//! `ddl forecast -`: forecasts from every frame of a tracker's lines.

use super::kept_memory::KeptMemory;
use super::{Forecast, Onward};
use crate::clock::Clock;
use crate::recordings;
use crate::telling::{tell, words};
use crate::units::{Units, live_step};
use anyhow::{Context as _, bail};
use ddl::Ddl;
use ddl::data::{
    Completion, Doubt, Frame, FrameReader, Homography, LiveTracks, MadeUp, Observation, Recording,
    Window,
};
use std::fs::File;
use std::io::{Write as _, stdin, stdout};
use std::path::Path;

/// Largest number of frames assumed to be 0.4 s: more may be a hole, or timestamps.
const LONGEST_STEP: i64 = 1000;

/// Forecasts from every frame once it is complete, until standard input ends or the output is closed.
pub(super) fn run(forecast: &Forecast) -> anyhow::Result<()> {
    let model = forecast.model()?;
    let memory = KeptMemory::open(forecast.memory.as_deref(), &model)?;
    let answered = answer(forecast, &model, &memory);
    // Keep the memory however the stream ended.
    let kept = memory.end();
    if let (Err(_), Err(error)) = (&answered, &kept) {
        tell(format_args!("error: {}", words(error)));
    }
    answered.and(kept)
}

fn answer(forecast: &Forecast, model: &Ddl, memory: &KeptMemory) -> anyhow::Result<()> {
    let units = forecast.tracks.live_units(model.config())?;
    let homography = units.homography()?;
    if let Some(note) = units.note_of_run(false) {
        tell(format_args!("note: {note}"));
    }
    let mut tracking = Tracking::new(forecast.tracks.completion(), units)?;
    memory.begin(model, tracking.frame_step())?;
    let mut output = Output::open(forecast.output.as_deref())?;
    let mut frames = FrameReader::new(stdin().lock(), "standard input");
    let (mut onward, mut empty, mut looked_at) = (Onward::default(), true, false);
    let mut wrong = None;
    while wrong.is_none() {
        memory.write_when_due();
        let frame = frames.next_frame().or_else(|error| {
            // keep the frames before the bad line
            wrong = Some(error);
            Ok::<_, anyhow::Error>(frames.unfinished())
        })?;
        let Some(frame) = frame else { break };
        empty = false;
        let frame = on_the_ground(frame, homography.as_ref())?;
        let names = frame.names.clone();
        let seen = (frame.number, frame.people.clone());
        let window = tracking.push(frame, frames.rate())?;
        memory.begin(model, tracking.frame_step())?;
        let Some(window) = memory.watch(&seen, window)? else {
            continue;
        };
        let window = window.with_names(names);
        if !looked_at {
            looked_at = warn_of_speeds(&window)?;
        }
        let text = forecast.text(model, &[window], Clock::WHOLE, &mut onward)?;
        output
            .write(&text)
            .with_context(|| match &forecast.output {
                Some(path) => format!(
                    "cannot continue to write {0}, which holds the forecasts so far (another run with --output {0} \
                     replaces them)",
                    path.display()
                ),
                None => "cannot write to standard output".to_owned(),
            })?;
    }
    if let Some(wrong) = wrong {
        return Err(wrong.into());
    }
    if empty {
        bail!(
            "standard input holds no tracks: the first line must be frame,pedestrian,x,y, followed by a row for each \
             pedestrian and frame"
        );
    }
    if !onward.headed {
        bail!(
            "standard input: no pedestrian was observed long enough to be forecast; give --fps or --frame-step if \
                 frame numbers are not 0.4 s apart"
        );
    }
    Ok(())
}

struct Output {
    /// `None` for standard output.
    file: Option<File>,
    /// Whether a forecast was written. The first forecast replaces an existing file; an input without forecasts does
    /// not.
    begun: bool,
}

impl Output {
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
    let whole = (0..window.len()).filter(|&i| window.made_up(i) == MadeUp::default());
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
    // A jump does not point to wrong units, and a pedestrian may be slow for 3.2 s.
    if let Some(doubt @ Doubt::Fast { .. }) = &recording.speed_doubt() {
        recordings::warn_of(doubt);
    }
    Ok(true)
}

fn on_the_ground(mut frame: Frame, homography: Option<&Homography>) -> anyhow::Result<Frame> {
    let Some(homography) = homography else {
        return Ok(frame);
    };
    for (pedestrian, position) in &mut frame.people {
        let seen = Observation::new(frame.number, *pedestrian, *position);
        *position = homography
            .place(&seen, &frame.names)
            .context("standard input")?;
    }
    Ok(frame)
}

/// Live tracks whose frame step may be unknown until the first two frames.
struct Tracking {
    completion: Completion,
    units: Units,
    tracks: Option<LiveTracks>,
    first: Option<Frame>,
}

impl Tracking {
    fn new(completion: Completion, units: Units) -> anyhow::Result<Self> {
        let tracks = match units.live_frame_step()? {
            None => None,
            Some(step) => Some(LiveTracks::with_frame_step(step)?.completing(completion)),
        };
        Ok(Self {
            completion,
            units,
            tracks,
            first: None,
        })
    }

    /// Raw frames in a step, once known.
    fn frame_step(&self) -> Option<i64> {
        self.tracks.as_ref().map(LiveTracks::frame_step)
    }

    /// Adds a frame; returns the window that ends there, if it has pedestrians to forecast. `rate`: frames per second
    /// according to the lines.
    fn push(&mut self, frame: Frame, rate: Option<f64>) -> anyhow::Result<Option<Window>> {
        if let Some(tracks) = &mut self.tracks {
            return Ok(tracks.push(frame.number, frame.people)?);
        }
        let Some(first) = self.first.take() else {
            self.first = Some(frame);
            return Ok(None);
        };
        let (step, reason) = self.step(frame.number - first.number, rate)?;
        tell(format_args!(
            "note: frame numbers are assumed to be {step} apart in 0.4 s, {reason}; give --fps or --frame-step if this \
             is wrong"
        ));
        let tracks = LiveTracks::with_frame_step(step)?.completing(self.completion);
        let tracks = self.tracks.insert(tracks);
        tracks.push(first.number, first.people)?;
        Ok(tracks.push(frame.number, frame.people)?)
    }

    /// Frame numbers in a step that no option gives, with the reason; `apart`: difference of the first two frame
    /// numbers.
    fn step(&self, apart: i64, rate: Option<f64>) -> anyhow::Result<(i64, String)> {
        if let Some(rate) = rate {
            let step = live_step(1.0 / (rate * apart as f64)).with_context(|| {
                format!(
                    "standard input: the scenes give {rate} frames per second, but the first two frames are {apart} \
                     apart"
                )
            })?;
            return Ok((step, format!("from the fps of the scenes, {rate}")));
        }
        if let Some(remembered) = self.units.remembered_live_frame_step()? {
            return Ok(remembered);
        }
        if apart > LONGEST_STEP {
            bail!(
                "standard input: the first two frames are {apart} apart; give the number of frames in 0.4 s with --fps \
                 or --frame-step"
            );
        }
        Ok((apart, "the difference of the first two frames".to_owned()))
    }
}
