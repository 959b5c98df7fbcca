//! Writers of observations for other programs, and of forecasts in the same format.

use std::io::Write;

use ddl_core::{Forecast, PedestrianName, Position, Window};
use serde::Serialize;

use crate::error::EvaluationError;
use crate::external::error::ExternalError;
use crate::external::pedestrian_key::last_observed;

#[derive(Serialize)]
struct WrittenPedestrian<'a> {
    recording: &'a str,
    observed_until: i64,
    pedestrian: PedestrianName,
    observed: &'a [Position],
}

#[derive(Serialize)]
struct WrittenForecast<'a> {
    recording: &'a str,
    observed_until: i64,
    pedestrian: PedestrianName,
    hypotheses: Vec<WrittenHypothesis<'a>>,
}

#[derive(Serialize)]
struct WrittenHypothesis<'a> {
    weight: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    goal: Option<Position>,
    positions: &'a [Position],
}

/// Writes the observations as JSON lines, one object for each pedestrian of each window.
///
/// Positions are `[x, y]` in metres, 0.4 s apart, the last one at `observed_until`; reading them gives the same bits.
///
/// ```text
/// {"recording":"zara01","observed_until":70,"pedestrian":3,"observed":[[x,y], ... 8 of them]}
/// ```
///
/// # Errors
/// [`ExternalError::Io`] when the writer fails.
pub fn write_windows(windows: &[Window], mut writer: impl Write) -> Result<(), ExternalError> {
    for window in windows {
        for i in 0..window.len() {
            let line = WrittenPedestrian {
                recording: window.recording(),
                observed_until: last_observed(window),
                pedestrian: window.name(i),
                observed: window.observed(i),
            };
            write_line(&mut writer, &line)?;
        }
    }
    writer.flush().map_err(cannot_write)
}

/// Writes forecasts as JSON lines, from which [`read`](super::read) returns the same bits, but without certificates.
///
/// # Errors
/// Windows and forecasts have different pedestrians, or the writer fails.
pub fn write_forecasts(
    windows: &[Window],
    forecasts: &[Forecast],
    mut writer: impl Write,
) -> Result<(), ExternalError> {
    EvaluationError::unless_one_each(windows, forecasts.len())?;
    for (window, forecast) in windows.iter().zip(forecasts) {
        EvaluationError::unless_same_pedestrians(window, forecast.pedestrians())?;
        for i in 0..window.len() {
            let hypotheses = (0..forecast.hypotheses())
                .map(|k| WrittenHypothesis {
                    weight: forecast.weight(i, k),
                    goal: forecast.goal(i, k),
                    positions: forecast.hypothesis(i, k),
                })
                .collect();
            let line = WrittenForecast {
                recording: window.recording(),
                observed_until: last_observed(window),
                pedestrian: window.name(i),
                hypotheses,
            };
            write_line(&mut writer, &line)?;
        }
    }
    writer.flush().map_err(cannot_write)
}

fn write_line(writer: &mut impl Write, line: &impl Serialize) -> Result<(), ExternalError> {
    serde_json::to_writer(&mut *writer, line).map_err(|error| cannot_write(error.into()))?;
    writer.write_all(b"\n").map_err(cannot_write)
}

fn cannot_write(source: std::io::Error) -> ExternalError {
    ExternalError::Io { origin: "cannot write".to_owned(), source }
}
