//! Forecasts in the order of the windows.

use ddl_core::{Forecast, HORIZON, Position, Window};
use ddl_data::Fault;
use sha2::{Digest as _, Sha256};

use crate::external::error::ExternalError;
use crate::external::expected::{ExpectedForecasts, Slot};
use crate::external::hint::NAMED;
use crate::external::pedestrian_key::{last_observed, named};

/// What to do if a file and the windows have different pedestrians.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Coverage {
    /// Fail: the file must forecast exactly the pedestrians of the windows.
    #[default]
    Whole,
    /// Score the pedestrians that are in both. The others still count for collisions with true futures and baselines,
    /// but not for the collision rate, JADE and JFDE, which compare forecasts.
    Intersection,
}

/// Windows with their forecasts from a file, in the order of the windows.
#[derive(Debug, Clone, PartialEq)]
pub struct Matched {
    /// The windows, reduced to the pedestrians with forecasts.
    pub windows: Vec<Window>,
    /// The same windows with all pedestrians.
    pub full_windows: Vec<Window>,
    /// Their forecasts.
    pub forecasts: Vec<Forecast>,
    /// The name of the file, without its folder.
    pub(crate) file: String,
    pedestrians: usize,
}

impl Matched {
    /// Number of pedestrians in the windows.
    pub fn pedestrians(&self) -> usize {
        self.pedestrians
    }

    /// Text that describes the scored part of the pedestrians, with a digest of them; `None` if all are scored.
    pub fn test_subset(&self) -> Option<String> {
        let scored: usize = self.windows.iter().map(Window::len).sum();
        (scored < self.pedestrians).then(|| {
            format!(
                "pedestrians forecast by another program: {scored} of {}, digest {}",
                self.pedestrians,
                self.digest()
            )
        })
    }

    /// The first 8 hexadecimal digits of the SHA-256 of recording, last observed frame and pedestrian of all
    /// pedestrians.
    fn digest(&self) -> String {
        let mut hash = Sha256::new();
        for window in &self.windows {
            let recording = window.recording();
            for pedestrian in window.pedestrians() {
                // The length comes first, so that different lists of pedestrians give different bytes.
                hash.update((recording.len() as u64).to_le_bytes());
                hash.update(recording);
                hash.update(last_observed(window).to_le_bytes());
                hash.update(pedestrian.0.to_le_bytes());
            }
        }
        let [a, b, c, d, ..]: [u8; 32] = hash.finalize().into();
        format!("{:08x}", u32::from_be_bytes([a, b, c, d]))
    }
}

impl ExpectedForecasts<'_> {
    pub(super) fn matched(self, coverage: Coverage) -> Result<Matched, ExternalError> {
        let pedestrians: usize = self.windows.iter().map(Window::len).sum();
        let forecast_count = self.slots.iter().flatten().flatten().count();
        if self.forecasts == 0 {
            let problem = "the file holds no forecast; is it empty or truncated?";
            return Err(Fault::from(problem).in_line(&self.origin, 1).into());
        }
        let refused = match coverage {
            Coverage::Whole => self.unknown.count > 0,
            Coverage::Intersection => forecast_count == 0,
        };
        if refused {
            let frames = self.windows.iter().map(last_observed);
            let range = frames.clone().min().zip(frames.max());
            let fitting = self.forecasts - self.unknown.count;
            return Err(ExternalError::Unknown {
                hint: self.unknown.hint(&self.recordings, range, fitting),
                origin: self.origin,
                unknown: self.unknown.count,
                forecasts: self.forecasts,
                first: self.unknown.first,
            });
        }
        if coverage == Coverage::Whole && forecast_count < pedestrians {
            return Err(ExternalError::Missing {
                missing: pedestrians - forecast_count,
                pedestrians,
                first: self.first_missing(),
                origin: self.origin,
            });
        }
        let mut matched = Matched {
            windows: Vec::with_capacity(self.windows.len()),
            full_windows: Vec::with_capacity(self.windows.len()),
            forecasts: Vec::with_capacity(self.windows.len()),
            file: self.origin.clone(),
            pedestrians,
        };
        for (window, slots) in self.windows.iter().zip(self.slots) {
            let Some(reduced) = window.filter_pedestrians(|i| slots[i].is_some()) else { continue };
            let slots: Vec<Slot> = slots.into_iter().flatten().collect();
            matched.windows.push(reduced);
            matched.full_windows.push(window.clone());
            let forecast =
                forecast(slots).map_err(|source| ExternalError::Shape { origin: self.origin.clone(), source })?;
            matched.forecasts.push(forecast);
        }
        Ok(matched)
    }

    fn first_missing(&self) -> Vec<String> {
        self.windows
            .iter()
            .zip(&self.slots)
            .flat_map(|(window, slots)| (0..window.len()).filter(|&i| slots[i].is_none()).map(move |i| (window, i)))
            .take(NAMED)
            .map(|(window, i)| {
                let name = window.name(i);
                named(Some(window.recording()), last_observed(window), &name)
            })
            .collect()
    }
}

fn forecast(slots: Vec<Slot>) -> Result<Forecast, ddl_core::ForecastShapeError> {
    let pedestrians = slots.len();
    let hypotheses = slots.first().map_or(0, |slot| slot.forecast.hypotheses());
    let mut positions: Vec<Position> = Vec::with_capacity(pedestrians * hypotheses * HORIZON);
    let mut weights = Vec::with_capacity(pedestrians * hypotheses);
    let mut goals: Option<Vec<Position>> = None;
    for slot in slots {
        let pedestrian = slot.forecast;
        positions.extend(pedestrian.positions);
        match pedestrian.weights {
            Some(given) => weights.extend(given),
            None => weights.extend(std::iter::repeat_n(1.0 / hypotheses as f64, hypotheses)),
        }
        if let Some(given) = pedestrian.goals {
            goals.get_or_insert_default().extend(given);
        }
    }
    Forecast::new(pedestrians, hypotheses, positions, weights, goals)
}
