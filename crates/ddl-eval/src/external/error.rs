//! Errors in files of forecasts, with their place and remedy.

use ddl_core::{ForecastError, ForecastShapeError};
use ddl_data::{DataError, FormatError};

use crate::error::EvaluationError;

/// Forecasts of another program cannot be read, matched or scored.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the messages describe the fields")]
pub enum ExternalError {
    #[error(transparent)]
    Data(#[from] DataError),
    #[error("{origin}: {source}")]
    Io { origin: String, source: std::io::Error },
    #[error(
        "{origin} forecasts {} of the {pedestrians} pedestrians in the windows; {missing} are missing, the first of \
         them \
         {}; forecast them too, or score the intersection only",
        pedestrians - missing, first.join(", ")
    )]
    Missing { origin: String, missing: usize, pedestrians: usize, first: Vec<String> },
    #[error(
        "{origin}: {unknown} of {forecasts} forecasts match no pedestrian of the windows, the first one {}; {hint}",
        first.join(", ")
    )]
    Unknown { origin: String, unknown: usize, forecasts: usize, first: Vec<String>, hint: String },
    #[error(
        "{origin}: half of the forecasts start {metres:.1} m or more from the pedestrian's last observed position; \
         {hint}"
    )]
    OutOfPlace { origin: String, metres: f64, hint: &'static str },
    #[error("two windows of `{recording}` are observed until frame {observed_until}: use the windows of one rule")]
    AmbiguousWindows { recording: String, observed_until: i64 },
    #[error(
        "forecasts of a file cannot be measured under the protocol `published`, in which the forecaster chooses the \
         goal with the TRUE end before it forecasts; use `fair` or `single`"
    )]
    Published,
    #[error("{origin}: {source}")]
    Shape { origin: String, source: ForecastShapeError },
    #[error(transparent)]
    Forecast(#[from] ForecastError),
    #[error(transparent)]
    Evaluation(#[from] EvaluationError),
}

impl From<FormatError> for ExternalError {
    fn from(error: FormatError) -> Self {
        Self::Data(error.into())
    }
}
