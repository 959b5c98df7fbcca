//! What can be wrong with a file of forecasts, said with the place and the remedy.

use std::path::PathBuf;

use ddl_data::PedestrianName;

use crate::error::{EvaluationError, ForecastError, ForecastShapeError, MeasureError};

/// Forecasts of another program cannot be read, matched or scored.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ExternalError {
    /// The file cannot be opened.
    #[error("cannot read {}: {source}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        source: std::io::Error,
    },
    /// Reading stopped, or writing failed.
    #[error("{origin}: {source}")]
    Io {
        /// The file.
        origin: String,
        /// The system's reason.
        source: std::io::Error,
    },
    /// A line is wrong.
    #[error("{origin}, line {line}{}: {problem}", field.as_deref().map(|f| format!(", {f}")).unwrap_or_default())]
    Line {
        /// The file.
        origin: String,
        /// Line, counted from 1.
        line: usize,
        /// The field, such as `hypotheses[3].positions[11][0]` or the name of a column; `None` when the
        /// whole line is meant.
        field: Option<String>,
        /// What is wrong there.
        problem: ExternalProblem,
    },
    /// Pedestrians of the windows that the file does not forecast.
    #[error(
        "{origin} forecasts {} of the {pedestrians} walkers in the windows; {missing} are missing, the first of them \
         {}; forecast them too, or score the intersection alone",
        pedestrians - missing, first.join(", ")
    )]
    Missing {
        /// The file.
        origin: String,
        /// Pedestrians without a forecast, counted once for each window.
        missing: usize,
        /// Pedestrians in all.
        pedestrians: usize,
        /// The first of those without.
        first: Vec<String>,
    },
    /// Forecasts of pedestrians that are in none of the windows.
    #[error(
        "{origin}: {unknown} of {forecasts} forecasts are of nobody in the windows, the first of {}; {hint}",
        first.join(", ")
    )]
    Unknown {
        /// The file.
        origin: String,
        /// Forecasts that belong to no pedestrian of the windows.
        unknown: usize,
        /// Forecasts in the file.
        forecasts: usize,
        /// Whom the first of them are of.
        first: Vec<String>,
        /// What may be the reason.
        hint: String,
    },
    /// The forecasts begin elsewhere than their pedestrians stand.
    #[error(
        "{origin}: half of the forecasts begin {metres:.1} m or more from the walker's last observed position; {hint}"
    )]
    OutOfPlace {
        /// The file.
        origin: String,
        /// Median distance of the first forecast position from the last observed one, m.
        metres: f64,
        /// What may be the reason.
        hint: &'static str,
    },
    /// Windows and forecasts to be written differ in number.
    #[error("{windows} windows but {forecasts} forecasts; there must be one forecast a window")]
    Count {
        /// Number of windows.
        windows: usize,
        /// Number of forecasts.
        forecasts: usize,
    },
    /// Two windows end their observation at the same frame of the same recording.
    #[error(
        "two windows of `{recording}` are observed until frame {observed_until}: give the windows of one rule"
    )]
    AmbiguousWindows {
        /// The recording.
        recording: String,
        /// The last observed raw frame.
        observed_until: i64,
    },
    /// The protocol `published` was asked for.
    #[error(
        "forecasts of a file cannot be measured under the protocol `published`: there the goal is chosen with the \
         TRUE end inside the forecaster, before it forecasts; a file's hypotheses are scored as they are, so ask for \
         `fair` or `single`"
    )]
    Published,
    /// What was read does not make a forecast.
    #[error("{origin}: {source}")]
    Shape {
        /// The file.
        origin: String,
        /// What is wrong.
        source: ForecastShapeError,
    },
    /// The forecasts break the rules of the protocol.
    #[error(transparent)]
    Forecast(#[from] ForecastError),
    /// The forecasts cannot be scored.
    #[error(transparent)]
    Evaluation(#[from] EvaluationError),
    /// A baseline cannot be measured.
    #[error(transparent)]
    Measure(#[from] MeasureError),
}

/// What can be wrong at one place of a file of forecasts.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ExternalProblem {
    /// The line is no JSON object.
    #[error("not a JSON object: {detail}")]
    Json {
        /// The reader's own words.
        detail: String,
    },
    /// The line is not UTF-8 text.
    #[error("the text is not UTF-8")]
    NotUtf8,
    /// The line is longer than any forecast.
    #[error("the line is longer than {limit} bytes; write one line a walker")]
    LongLine {
        /// Bytes that a line may have.
        limit: usize,
    },
    /// A position farther from the origin than [`COORDINATE_LIMIT`](ddl_data::COORDINATE_LIMIT).
    #[error(
        "must lie within {limit} m of the origin, found {found}",
        limit = ddl_data::COORDINATE_LIMIT
    )]
    TooFar {
        /// The coordinate, m.
        found: f64,
    },
    /// The file holds nothing.
    #[error("the file holds no forecast; is it empty or cut off?")]
    Empty,
    /// The header of the table lacks a column, or has it twice.
    #[error(
        "the header must name the columns observed_until, pedestrian, frame, x and y, and may name recording, \
         hypothesis, weight and others, each once: {detail}"
    )]
    Header {
        /// Which column is the trouble.
        detail: String,
    },
    /// A row has too few or too many fields.
    #[error("{found} fields where the header names {expected}")]
    FieldCount {
        /// Columns of the header.
        expected: usize,
        /// Fields of the row.
        found: usize,
    },
    /// A field is not there.
    #[error("is missing")]
    Missing,
    /// A field holds something of another kind.
    #[error("must be {expected}, found {found}")]
    Kind {
        /// What it must be.
        expected: &'static str,
        /// What it is, shortened.
        found: String,
    },
    /// A coordinate or weight is NaN, infinite or no number.
    #[error(
        "must be a finite number, found {found}; a model that diverged must be reported as such, not scored"
    )]
    NotFinite {
        /// What it is, shortened.
        found: String,
    },
    /// Not 12 positions.
    #[error(
        "{found} positions; a forecast has {expected}, one each 0.4 s after the last observed frame"
    )]
    Length {
        /// Positions of a forecast.
        expected: usize,
        /// Positions found.
        found: usize,
    },
    /// The frames of the forecast are not the 12 that follow.
    #[error(
        "the forecast is of the frames {found}; the 12 after the last observed one are {expected}"
    )]
    Frames {
        /// The frames to forecast, in short.
        expected: String,
        /// The frames found, in short.
        found: String,
    },
    /// The frames of a scene are not those of the window that starts with it.
    #[error(
        "the scene has the frames {found}; the window that starts there has the observed frames {observed} and the forecast frames \
         {ahead}: a scene is 8 or 9 observed and 12 forecast frames, {step} s apart",
        step = ddl_data::TIME_STEP
    )]
    SceneFrames {
        /// First and last frame of the scene.
        found: String,
        /// The observed frames of the window, in short.
        observed: String,
        /// The frames to forecast, in short.
        ahead: String,
    },
    /// Hypotheses differ in number.
    #[error(
        "{found} hypotheses, but {expected} on line {first_line}; the best of K needs one K for all walkers"
    )]
    Hypotheses {
        /// Hypotheses of the first pedestrian.
        expected: usize,
        /// Hypotheses of this one.
        found: usize,
        /// Line of the first pedestrian.
        first_line: usize,
    },
    /// More hypotheses than any protocol allows.
    #[error(
        "more than {allowed} hypotheses of {pedestrian}; the protocols allow {allowed}: choose before you write, without \
         the true future"
    )]
    TooManyHypotheses {
        /// Whom they are of.
        pedestrian: String,
        /// Hypotheses allowed.
        allowed: usize,
    },
    /// The numbers of a pedestrian's hypotheses are not those that every pedestrian has.
    #[error(
        "the hypotheses of {pedestrian} have the numbers {numbers}: those of one number are one joint \
         future, so number them alike for all walkers"
    )]
    Numbers {
        /// Whom they are of.
        pedestrian: String,
        /// The numbers that it has, and those that it should have.
        numbers: String,
    },
    /// A field of a JSON object twice.
    #[error("is there twice; keep one")]
    TwiceNamed,
    /// A quote is opened and not closed.
    #[error("a quote is opened and not closed on this line")]
    OpenQuote,
    /// No hypothesis.
    #[error("at least one hypothesis is needed")]
    NoHypothesis,
    /// Rows of one hypothesis are apart, or one is there twice.
    #[error(
        "hypothesis {hypothesis} is there already; the rows of a hypothesis must stand together"
    )]
    Scattered {
        /// The hypothesis.
        hypothesis: i64,
    },
    /// Some hypotheses have a weight and some none.
    #[error("either every hypothesis of a walker has a weight or none has")]
    WeightsOfSome,
    /// A weight is below zero.
    #[error("a weight must not be below 0, found {found}")]
    NegativeWeight {
        /// The weight.
        found: f64,
    },
    /// The weights do not sum to 1.
    #[error("the weights sum to {sum}, not to 1; divide them by their sum")]
    WeightSum {
        /// Their sum.
        sum: f64,
    },
    /// The rows of one hypothesis name different weights.
    #[error("weight {found}, but {first} in the row before; a hypothesis has one weight")]
    WeightChanges {
        /// The weight of the row before.
        first: f64,
        /// The weight of this row.
        found: f64,
    },
    /// Some forecasts name goals and some do not.
    #[error(
        "either every hypothesis of the file has a goal or none has (line {first_line} decided)"
    )]
    GoalsOfSome {
        /// Line of the first pedestrian.
        first_line: usize,
    },
    /// A pedestrian twice.
    #[error("this walker was forecast on line {first_line} already; keep one")]
    Duplicate {
        /// Line of the first forecast.
        first_line: usize,
    },
    /// Two scenes forecast the same pedestrian differently, and neither as its primary pedestrian.
    #[error(
        "pedestrian {pedestrian} is a neighbour in two scenes that forecast it differently (line {first_line}); make it \
         the primary pedestrian of one"
    )]
    Neighbours {
        /// The pedestrian.
        pedestrian: PedestrianName,
        /// Line of the other forecast.
        first_line: usize,
    },
    /// The recording is not named, and the windows are of several.
    #[error("is missing, and the windows are of several recordings: {}", known.join(", "))]
    WhichRecording {
        /// The recordings.
        known: Vec<String>,
    },
    /// A forecast names a scene that no scene line described.
    #[error("scene {scene} has no scene line before its tracks")]
    UnknownScene {
        /// The scene.
        scene: i64,
    },
    /// Tracks of a scene are apart, or its scene line is there twice.
    #[error(
        "scene {scene} was finished on an earlier line; the tracks of a scene must stand together"
    )]
    ScatteredScene {
        /// The scene.
        scene: i64,
    },
}
