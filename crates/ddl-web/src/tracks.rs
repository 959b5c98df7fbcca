//! Tracks of a file, what the program tells of them, and their forecasts.

use crate::exchange::Failure;
use crate::model;
use crate::options::Options;
use ddl::data::{Clock, Format, Window, parse_columns};
use ddl::memory::{Playback, SceneMemory};
use ddl::{
    AdaptiveRegions, Forecast, Forecaster as _, Moment, OWN_CLOCKS, ObservedTracks, TimedRecording, TrackUnits,
    UnfamiliarMotions,
};
use std::path::Path;

/// Largest number of forecasts at once: in node they take 2.6 GiB, with three regions 5 GiB.
const MOST: usize = 40_000;

pub(crate) struct Tracks {
    pub(crate) observed: ObservedTracks,
    /// Notes and warnings, a line each, as the program prints them.
    pub(crate) told: Vec<String>,
}

impl Tracks {
    pub(crate) fn read(name: &str, bytes: &[u8], options: &Options) -> Result<Self, Failure> {
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
        let notes = timed.notes.iter().chain(&timed.guessed);
        let mut told: Vec<String> = notes.map(|note| format!("note: {note}")).collect();
        let tracks = options.windows_of(timed.recording.live_tracks())?;
        let observed = ObservedTracks::new((timed.recording, timed.clock), tracks, options.last);
        if !observed.has_common_frames && options.are_all() {
            told.push(format!("note: {OWN_CLOCKS} (--every)"));
        }
        let warning = observed.warning.as_ref();
        told.extend(warning.map(|warning| format!("warning: {}", ddl::words_of_warning(warning))));
        if let Some(problem) = observed.problem() {
            told.push(format!("{name}: {problem}"));
            return Err(told.join("\n").into());
        }
        told.extend(observed.estimated());
        Ok(Self { observed, told })
    }

    /// These forecasts as JSON lines, and what is told of the tracks and of their motions.
    pub(crate) fn answer(
        &self,
        windows: &[Window],
        forecasts: &[Forecast],
        options: &Options,
    ) -> Result<(String, Vec<String>), Failure> {
        let mut motions = UnfamiliarMotions::default();
        let lines = lines(windows, forecasts, self.observed.clock, options, &mut motions)?;
        Ok((lines, motions.warning().into_iter().chain(self.told.iter().cloned()).collect()))
    }

    /// Some of its windows, with the tracks of earlier pedestrians if they are asked for.
    pub(crate) fn windows(&self, windows: Vec<Window>, options: &Options) -> Result<Vec<Window>, Failure> {
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
        let step = self.observed.recording.frame_step();
        Ok(SceneMemory::new(step, SceneMemory::DEFAULT_CAPACITY)?)
    }
}

/// The forecasts of windows in order of time; with regions they adapt from one to the next.
pub(crate) fn forecasts(windows: &[Window], options: &Options) -> Result<Vec<Forecast>, Failure> {
    let count: usize = windows.iter().map(Window::len).sum();
    if count > MOST {
        let problem = format!("{count} forecasts exceed the {MOST} that memory holds: take fewer (every, last)");
        return Err(problem.into());
    }
    let model = model()?;
    if options.joint {
        return Ok(model.forecast_scenes(windows, None)?);
    }
    let forecasts = model.forecast_all(windows)?;
    if options.regions()?.is_empty() {
        return Ok(forecasts);
    }
    let mut adaptive = AdaptiveRegions::default();
    let pairs = windows.iter().zip(forecasts);
    Ok(pairs.map(|(window, forecast)| adaptive.adapt(window, forecast)).collect())
}

/// Forecasts as the program's JSON lines. Motions unlike the training motions are counted.
pub(crate) fn lines(
    windows: &[Window],
    forecasts: &[Forecast],
    clock: Clock,
    options: &Options,
    motions: &mut UnfamiliarMotions,
) -> Result<String, Failure> {
    let pairs = windows.iter().zip(forecasts);
    let moments = pairs.map(|(window, forecast)| Moment::new(window, forecast, clock));
    let moments: Vec<Moment<'_>> = moments.collect();
    motions.add(&moments);
    let of_moments = if options.joint { ddl::joint_lines } else { ddl::json_lines };
    Ok(of_moments(&moments, options.regions()?)?)
}
