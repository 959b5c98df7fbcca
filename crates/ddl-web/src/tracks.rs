//! Tracks of a file, what the program tells of them, and their forecasts.

use crate::exchange::Failure;
use crate::model::model;
use crate::options::BrowserOptions;
use ddl::data::{Clock, Format, Window, parse_columns};
use ddl::memory::{Playback, SceneMemory};
use ddl::{Answer, Moment, Note, ObservedTracks, Setting, TimedRecording, TrackUnits, UnfamiliarMotions};
use std::path::Path;

/// Largest number of forecasts at once: in node they take 2.6 GiB, with three regions 5 GiB.
const MOST: usize = 40_000;

pub(crate) struct FileTracks {
    pub(crate) observed: ObservedTracks,
    /// Notes and warnings, a line each, as the program prints them.
    told: Vec<String>,
}

impl FileTracks {
    pub(crate) fn read(name: &str, bytes: &[u8], options: &BrowserOptions) -> Result<Self, Failure> {
        if bytes.starts_with(b"\x89MCAP") {
            let words = "an MCAP file is not read here; the program reads it: ddl forecast";
            return Err(format!("{name}: {words} {name}").into());
        }
        let (choice, units) = (options.choice()?, options.units()?);
        let format = Format::guess(Path::new(name), bytes, &choice)?;
        let stem = Path::new(name).file_stem().unwrap_or_default().to_string_lossy();
        let mut rows = parse_columns(bytes, name, format, &choice)?.with_name(&*stem);
        if let Some(homography) = units.homography {
            rows = homography.to_ground(&rows).map_err(|error| format!("{name}: {error}"))?;
        }
        let timed = TimedRecording::new(&rows, &units, &TrackUnits::default());
        let timed = timed.map_err(|error| format!("{name}: {error}"))?;
        let mut told: Vec<String> = timed.notes.iter().chain(&timed.guessed).map(Note::line).collect();
        let windows = options.windows();
        let tracks = windows.tracks(timed.recording.live_tracks())?;
        let observed = ObservedTracks::new((timed.recording, timed.clock), tracks, windows.last);
        if !observed.has_common_frames && windows.are_all() {
            told.push(format!("{} ({})", Note::OwnClocks.line(), Setting::Every));
        }
        told.extend(observed.warning.clone().map(|warning| Note::Implausible(warning).line()));
        if let Some(problem) = observed.problem() {
            told.push(format!("{name}: {problem}"));
            return Err(told.join("\n").into());
        }
        told.extend(observed.estimated().iter().map(Note::line));
        Ok(Self { observed, told })
    }

    /// These answers as JSON lines, and what is told of the tracks and of their motions.
    pub(crate) fn lines(
        &self,
        windows: &[Window],
        answers: &[Answer],
        options: &BrowserOptions,
    ) -> Result<(String, Vec<String>), Failure> {
        let mut motions = UnfamiliarMotions::default();
        let lines = lines(windows, answers, self.observed.clock, options, &mut motions)?;
        let warning = motions.warning().map(|note| note.line());
        Ok((lines, warning.into_iter().chain(self.told.iter().cloned()).collect()))
    }

    /// Some of its windows, with the tracks of earlier pedestrians if they are asked for.
    pub(crate) fn windows(&self, windows: Vec<Window>, options: &BrowserOptions) -> Result<Vec<Window>, Failure> {
        if !options.memory {
            return Ok(windows);
        }
        let count = model()?.goal_model().recalled_per_pedestrian()?;
        Ok(self.empty_memory()?.replay(&self.observed.recording, Playback::Forward, windows, count)?)
    }

    /// A picture of where its pedestrians walk, appear and disappear, as SVG.
    pub(crate) fn place(&self) -> Result<String, Failure> {
        let mut memory = self.empty_memory()?;
        memory.observe_recording(&self.observed.recording)?;
        let tracks: Vec<_> = memory.tracks().collect();
        let numbers = format!("{} segments of {} tracks", memory.segments(), tracks.len());
        Ok(ddl::report::figure::place(self.observed.recording.name(), &numbers, &tracks))
    }

    fn empty_memory(&self) -> Result<SceneMemory, Failure> {
        Ok(SceneMemory::new(self.observed.recording.frame_step(), SceneMemory::DEFAULT_CAPACITY)?)
    }
}

/// The answers to windows in order of time.
pub(crate) fn answers(windows: &[Window], options: &BrowserOptions) -> Result<Vec<Answer>, Failure> {
    let count: usize = windows.iter().map(Window::len).sum();
    if count > MOST {
        let problem = format!("{count} forecasts exceed the {MOST} that memory holds: take fewer (every, last)");
        return Err(problem.into());
    }
    Ok(model()?.forecast(windows, &options.request()?)?)
}

/// Answers as the program's JSON lines. Motions unlike the training motions are counted.
pub(crate) fn lines(
    windows: &[Window],
    answers: &[Answer],
    clock: Clock,
    options: &BrowserOptions,
    motions: &mut UnfamiliarMotions,
) -> Result<String, Failure> {
    let moments = windows.iter().zip(answers).map(|(window, answer)| Moment::new(window, answer, clock));
    let moments: Vec<Moment<'_>> = moments.collect();
    motions.add(&moments);
    let regions = ddl::WantedRegions { levels: options.regions()?, ..Default::default() };
    Ok(ddl::json_lines(&moments, regions)?)
}
