//! The pedestrians of the windows, each with its forecast of the file.

use std::collections::HashMap;

use ddl_core::{Forecast, HORIZON, OBSERVED, Position, Window};
use ddl_data::{Fault, Problem};

use crate::external::error::ExternalError;
use crate::external::hint::Unknown;
use crate::external::pedestrian_key::{PedestrianKey, frames_ahead, last_observed, wrong_frames};

#[derive(Debug, Default)]
pub(super) struct PedestrianForecast {
    /// `[K][12]`, metres.
    pub(super) positions: Vec<Position>,
    /// `[K]`; `None` for equal weights.
    pub(super) weights: Option<Vec<f64>>,
    /// `[K]`, metres.
    pub(super) goals: Option<Vec<Position>>,
    /// The 12 raw frames, where the file names them.
    pub(super) frames: Option<Vec<i64>>,
}

impl PedestrianForecast {
    pub(super) fn hypotheses(&self) -> usize {
        self.positions.len() / HORIZON
    }

    fn check_weights(&self) -> Result<(), Problem> {
        let Some(weights) = &self.weights else { return Ok(()) };
        if let Some(&found) = weights.iter().find(|&&weight| weight < 0.0) {
            return Err(format!("a weight must not be below 0, found {found}").into());
        }
        let sum: f64 = weights.iter().sum();
        if (sum - 1.0).abs() > Forecast::WEIGHT_TOLERANCE {
            return Err(format!("the weights sum to {sum}, not to 1; divide them by their sum").into());
        }
        Ok(())
    }
}

pub(super) struct Slot {
    pub(super) forecast: PedestrianForecast,
    line: usize,
}

#[derive(Default)]
pub(super) struct ExpectedForecasts<'a> {
    pub(super) origin: String,
    pub(super) windows: &'a [Window],
    pub(super) recordings: Vec<&'a str>,
    /// Index of the window by index of the recording and last observed frame.
    by_last: HashMap<(usize, i64), usize>,
    /// `[window][pedestrian]`.
    pub(super) slots: Vec<Vec<Option<Slot>>>,
    hypotheses: Option<(usize, usize)>,
    goals: Option<(bool, usize)>,
    pub(super) forecasts: usize,
    pub(super) unknown: Unknown,
}

impl<'a> ExpectedForecasts<'a> {
    pub(super) fn of(windows: &'a [Window], origin: &str) -> Result<Self, ExternalError> {
        let mut expected =
            Self { origin: origin.to_owned(), windows, slots: Vec::with_capacity(windows.len()), ..Self::default() };
        for (index, window) in windows.iter().enumerate() {
            let name = window.recording();
            let recording = expected.index_of(name).unwrap_or_else(|| {
                expected.recordings.push(name);
                expected.recordings.len() - 1
            });
            let observed_until = last_observed(window);
            if expected.by_last.insert((recording, observed_until), index).is_some() {
                return Err(ExternalError::AmbiguousWindows { recording: name.to_owned(), observed_until });
            }
            expected.slots.push(window.pedestrians().iter().map(|_| None).collect());
        }
        Ok(expected)
    }

    fn index_of(&self, recording: &str) -> Option<usize> {
        self.recordings.iter().position(|&name| name == recording)
    }

    fn window(&self, recording: usize, observed_until: i64) -> Option<usize> {
        self.by_last.get(&(recording, observed_until)).copied()
    }

    /// The index of the named recording. Without a name, the index of the only recording. `None` for an unknown name.
    pub(super) fn recording(&self, name: Option<&str>) -> Result<Option<usize>, Fault> {
        match name {
            Some(name) => Ok(self.index_of(name)),
            None if self.recordings.len() > 1 => {
                let names = self.recordings.join(", ");
                let problem = format!("is missing, but the windows have several recordings: {names}");
                Err(Fault::named("recording", problem))
            }
            None => Ok(self.recordings.first().map(|_| 0)),
        }
    }

    /// Adds the forecast of a pedestrian from a line.
    pub(super) fn put(&mut self, who: &PedestrianKey, forecast: PedestrianForecast, line: usize) -> Result<(), Fault> {
        self.forecasts += 1;
        self.check(&forecast, line)?;
        let recording = self.recording(who.recording.as_deref())?;
        let window = recording.and_then(|r| self.window(r, who.observed_until));
        let place = window.and_then(|window| {
            let pedestrian = self.windows[window].named(&who.pedestrian)?;
            Some((window, pedestrian))
        });
        let Some((window, pedestrian)) = place else {
            self.remember_unknown(who, recording);
            return Ok(());
        };
        check_frames(&self.windows[window], forecast.frames.as_deref())?;
        let slot = &mut self.slots[window][pedestrian];
        if let Some(Slot { line: first_line, .. }) = slot {
            return Err(Fault::from(format!("line {first_line} already forecasts this pedestrian; keep one")));
        }
        *slot = Some(Slot { forecast, line });
        Ok(())
    }

    fn check(&mut self, forecast: &PedestrianForecast, line: usize) -> Result<(), Fault> {
        let found = forecast.hypotheses();
        if found == 0 {
            return Err(Fault::from("at least one hypothesis is needed"));
        }
        let (expected, first_line) = *self.hypotheses.get_or_insert((found, line));
        if found != expected {
            return Err(Fault::from(format!(
                "{found} hypotheses, but {expected} on line {first_line}; the best of K needs the same K for all \
                 pedestrians"
            )));
        }
        let has_goals = forecast.goals.is_some();
        let (expected, first_line) = *self.goals.get_or_insert((has_goals, line));
        if has_goals != expected {
            return Err(Fault::from(format!(
                "all hypotheses of the file must have goals, or none (as on line {first_line})"
            )));
        }
        forecast.check_weights().map_err(|problem| Fault::named("weight", problem))
    }

    fn remember_unknown(&mut self, who: &PedestrianKey, recording: Option<usize>) {
        let recording_name = recording.map(|r| self.recordings[r]);
        let in_window = |until: i64| {
            let window = recording.and_then(|r| self.window(r, until));
            window.is_some_and(|w| self.windows[w].named(&who.pedestrian).is_some())
        };
        let step = self.windows.first().map_or(1, Window::frame_step);
        let as_first_frame = in_window(who.observed_until.saturating_add(step * (OBSERVED as i64 - 1)));
        let as_next_frame = in_window(who.observed_until.saturating_sub(step));
        self.unknown.remember(who, recording_name, as_first_frame, as_next_frame);
    }
}

fn check_frames(window: &Window, frames: Option<&[i64]>) -> Result<(), Fault> {
    let Some(found) = frames else { return Ok(()) };
    let ahead = frames_ahead(window);
    if ahead.iter().any(|frames| frames == found) {
        return Ok(());
    }
    Err(Fault::named("frames", wrong_frames(found, &ahead[0])))
}
