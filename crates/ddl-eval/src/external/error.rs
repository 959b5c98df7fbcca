//! Errors in files of forecasts, with their place and remedy.

use std::path::PathBuf;

use ddl_core::{ForecastError, ForecastShapeError, PedestrianName};

use crate::error::{EvaluationError, MeasureError};

/// Forecasts of another program cannot be read, matched or scored.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the messages describe the fields")]
pub enum ExternalError {
    #[error("cannot read {}: {source}", path.display())]
    File { path: PathBuf, source: std::io::Error },
    #[error("{origin}: {source}")]
    Io { origin: String, source: std::io::Error },
    #[error("{origin}, line {line}{}: {problem}", field.as_deref().map(|f| format!(", {f}")).unwrap_or_default())]
    Line {
        origin: String,
        line: usize,
        field: Option<String>,
        problem: String,
    },
    #[error(
        "{origin} forecasts {} of the {pedestrians} pedestrians in the windows; {missing} are missing, the first of \
         them \
         {}; forecast them too, or score the intersection only",
        pedestrians - missing, first.join(", ")
    )]
    Missing {
        origin: String,
        missing: usize,
        pedestrians: usize,
        first: Vec<String>,
    },
    #[error(
        "{origin}: {unknown} of {forecasts} forecasts match no pedestrian of the windows, the first one {}; {hint}",
        first.join(", ")
    )]
    Unknown {
        origin: String,
        unknown: usize,
        forecasts: usize,
        first: Vec<String>,
        hint: String,
    },
    #[error(
        "{origin}: half of the forecasts start {metres:.1} m or more from the pedestrian's last observed position; \
         {hint}"
    )]
    OutOfPlace {
        origin: String,
        metres: f64,
        hint: &'static str,
    },
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
    #[error(transparent)]
    Measure(#[from] MeasureError),
}

/// An error at one place of a file of forecasts.
#[derive(Debug, thiserror::Error)]
pub(super) enum ExternalProblem {
    #[error("not a JSON object: {detail}")]
    Json { detail: String },
    #[error("the text is not UTF-8")]
    NotUtf8,
    #[error("the line is longer than {limit} bytes; write one line for each pedestrian")]
    LongLine { limit: usize },
    #[error(
        "must lie within {limit} m of the origin, found {found}",
        limit = ddl_data::COORDINATE_LIMIT
    )]
    TooFar { found: f64 },
    #[error("the file holds no forecast; is it empty or truncated?")]
    Empty,
    #[error(
        "the header must name the columns observed_until, pedestrian, frame, x and y, and may name recording, \
         hypothesis, weight and others, each once: {detail}"
    )]
    Header { detail: String },
    #[error("{found} fields where the header names {expected}")]
    FieldCount { expected: usize, found: usize },
    #[error("is missing")]
    Missing,
    #[error("must be {expected}, found {found}")]
    Kind { expected: &'static str, found: String },
    #[error("must be a finite number, found {found}; a model that diverged must be reported as such, not scored")]
    NotFinite { found: String },
    #[error("{found} positions; a forecast has {expected}, 0.4 s apart, after the last observed frame")]
    Length { expected: usize, found: usize },
    #[error("the forecast has the frames {found}; the 12 after the last observed one are {expected}")]
    Frames { expected: String, found: String },
    #[error(
        "the scene has the frames {found}; the window that starts there has the observed frames {observed} and the \
         forecast frames {ahead}: a scene has 8 or 9 observed and 12 forecast frames, {step} s apart",
        step = ddl_data::TIME_STEP
    )]
    SceneFrames {
        found: String,
        observed: String,
        ahead: String,
    },
    #[error(
        "{found} hypotheses, but {expected} on line {first_line}; the best of K needs the same K for all pedestrians"
    )]
    Hypotheses {
        expected: usize,
        found: usize,
        first_line: usize,
    },
    #[error(
        "more than {allowed} hypotheses of {pedestrian}; the protocols allow {allowed}: choose them without the true \
         future"
    )]
    TooManyHypotheses { pedestrian: String, allowed: usize },
    #[error(
        "the hypotheses of {pedestrian} have the numbers {numbers}; a number stands for one joint future, so number \
         them alike for all pedestrians"
    )]
    Numbers { pedestrian: String, numbers: String },
    #[error("appears twice; keep one")]
    TwiceNamed,
    #[error("a quote is not closed on this line")]
    OpenQuote,
    #[error("at least one hypothesis is needed")]
    NoHypothesis,
    #[error("hypothesis {hypothesis} appeared before; the rows of a hypothesis must be consecutive")]
    Scattered { hypothesis: i64 },
    #[error("all hypotheses of a pedestrian must have weights, or none")]
    WeightsOfSome,
    #[error("a weight must not be below 0, found {found}")]
    NegativeWeight { found: f64 },
    #[error("the weights sum to {sum}, not to 1; divide them by their sum")]
    WeightSum { sum: f64 },
    #[error("weight {found}, but {first} in the row before; a hypothesis has one weight")]
    WeightChanges { first: f64, found: f64 },
    #[error("all hypotheses of the file must have goals, or none (as on line {first_line})")]
    GoalsOfSome { first_line: usize },
    #[error("line {first_line} already forecasts this pedestrian; keep one")]
    Duplicate { first_line: usize },
    #[error(
        "pedestrian {pedestrian} is a neighbour in two scenes that forecast it differently (line {first_line}); make \
         it \
         the primary pedestrian of one"
    )]
    Neighbours {
        pedestrian: PedestrianName,
        first_line: usize,
    },
    #[error("is missing, but the windows have several recordings: {}", known.join(", "))]
    WhichRecording { known: Vec<String> },
    #[error("scene {scene} has no scene line before its tracks")]
    UnknownScene { scene: i64 },
    #[error("scene {scene} ended on an earlier line; the tracks of a scene must be consecutive")]
    ScatteredScene { scene: i64 },
}
