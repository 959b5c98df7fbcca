//! Errors of windows and forecasts.

use thiserror::Error;

use crate::pedestrian::PedestrianId;
use crate::position::{OBSERVED, Position, WINDOW};

/// Tracks that cannot form a [`Window`](crate::Window).
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the messages say what the fields are")]
pub enum WindowError {
    #[error("a window needs at least one pedestrian")]
    Empty,
    #[error("{pedestrians} pedestrian ids but {tracks} tracks; give one track for each id")]
    Count { pedestrians: usize, tracks: usize },
    #[error(
        "pedestrian {pedestrian}: a track of {found} positions; every track of a window must have \
         {observed} positions (observation only), or every track {whole} (with the future)",
        observed = OBSERVED,
        whole = WINDOW
    )]
    Length { pedestrian: PedestrianId, found: usize },
    #[error("pedestrian {pedestrian}, position {index} of the track: {position:?} is not finite")]
    NotFinite { pedestrian: PedestrianId, index: usize, position: Position },
    #[error("pedestrian {pedestrian} is in the window twice")]
    Duplicate { pedestrian: PedestrianId },
    #[error(
        "start frame {start_frame} with a step of {frame_step}: the step must lie in 1..=2^31 and frames below 2^53"
    )]
    Frames { start_frame: i64, frame_step: i64 },
}

/// The numbers do not make a valid [`Forecast`](crate::Forecast).
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the messages say what the fields are")]
pub enum ForecastShapeError {
    #[error("a forecast needs at least one pedestrian and one hypothesis, found {pedestrians} x {hypotheses}")]
    Empty { pedestrians: usize, hypotheses: usize },
    #[error("`{field}` must hold {expected} entries ({layout}), found {found}")]
    Length { field: &'static str, layout: &'static str, expected: usize, found: usize },
    #[error(
        "`{field}` of pedestrian {pedestrian}, hypothesis {hypothesis} is not finite; \
         a model that diverged must be reported as such, not scored"
    )]
    NotFinite { field: &'static str, pedestrian: usize, hypothesis: usize },
    #[error("the weight of pedestrian {pedestrian}, hypothesis {hypothesis} is {weight}, below 0")]
    NegativeWeight { pedestrian: usize, hypothesis: usize, weight: f64 },
    #[error("the {field} of pedestrian {pedestrian} is {value}, out of range")]
    OutOfRange { field: &'static str, pedestrian: usize, value: f64 },
    #[error("the weights of pedestrian {pedestrian} sum to {sum}, not to 1; divide them by their sum")]
    NotNormalised { pedestrian: usize, sum: f64 },
}

/// A forecaster cannot make its forecast.
#[derive(Debug, Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the messages say what the fields are")]
pub enum ForecastError {
    #[error(transparent)]
    Shape(#[from] ForecastShapeError),
    #[error(
        "`{forecaster}` reads the true future, which the window of `{recording}` starting at frame \
         {start_frame} does not show (protocols `fair` and `single` never show it)"
    )]
    FutureMissing { forecaster: String, recording: String, start_frame: i64 },
    #[error("goal source `{goal_source}`: {problem}")]
    Goals { goal_source: String, problem: String },
    #[error("protocol `{protocol}` allows {allowed} hypotheses for each pedestrian, `{forecaster}` made {found}")]
    TooManyHypotheses { protocol: &'static str, forecaster: String, allowed: usize, found: usize },
    #[error("`{forecaster}` failed")]
    Model { forecaster: String, source: Box<dyn std::error::Error + Send + Sync> },
}

impl ForecastError {
    /// Wraps the error of a model.
    pub fn model(forecaster: impl Into<String>, source: impl Into<Box<dyn std::error::Error + Send + Sync>>) -> Self {
        Self::Model { forecaster: forecaster.into(), source: source.into() }
    }
}
