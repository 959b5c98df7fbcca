//! Errors of forecasts and of their scoring.

use ddl_data::{HORIZON, Window};

use crate::Protocol;

/// The numbers do not make a valid [`Forecast`](crate::Forecast).
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the messages describe the fields")]
pub enum ForecastShapeError {
    #[error("a forecast needs at least one pedestrian and one hypothesis, found {pedestrians} x {hypotheses}")]
    Empty { pedestrians: usize, hypotheses: usize },
    #[error("`{field}` must hold {expected} entries ({layout}), found {found}")]
    Length {
        field: &'static str,
        layout: &'static str,
        expected: usize,
        found: usize,
    },
    #[error(
        "`{field}` of pedestrian {pedestrian}, hypothesis {hypothesis} is not finite; \
         a model that diverged must be reported as such, not scored"
    )]
    NotFinite {
        field: &'static str,
        pedestrian: usize,
        hypothesis: usize,
    },
    #[error("the weight of pedestrian {pedestrian}, hypothesis {hypothesis} is {weight}, below 0")]
    NegativeWeight {
        pedestrian: usize,
        hypothesis: usize,
        weight: f64,
    },
    #[error("the {field} of pedestrian {pedestrian} is {value}, out of range")]
    OutOfRange {
        field: &'static str,
        pedestrian: usize,
        value: f64,
    },
    #[error("the weights of pedestrian {pedestrian} sum to {sum}, not to 1; divide them by their sum")]
    NotNormalised { pedestrian: usize, sum: f64 },
}

/// A forecaster cannot make its forecast.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the messages describe the fields")]
pub enum ForecastError {
    #[error(transparent)]
    Shape(#[from] ForecastShapeError),
    #[error(
        "`{forecaster}` reads the true future, which the window of `{recording}` starting at frame \
         {start_frame} does not show (protocols `fair` and `single` never show it)"
    )]
    FutureMissing {
        forecaster: String,
        recording: String,
        start_frame: i64,
    },
    #[error("goal source `{goal_source}`: {problem}")]
    Goals { goal_source: String, problem: String },
    #[error("protocol `{protocol}` allows {allowed} hypotheses for each pedestrian, `{forecaster}` made {found}")]
    TooManyHypotheses {
        protocol: Protocol,
        forecaster: String,
        allowed: usize,
        found: usize,
    },
    #[error("`{forecaster}` failed")]
    Model {
        forecaster: String,
        source: Box<dyn std::error::Error + Send + Sync>,
    },
}

impl ForecastError {
    /// Wraps the error of a model.
    pub fn model(forecaster: impl Into<String>, source: impl Into<Box<dyn std::error::Error + Send + Sync>>) -> Self {
        Self::Model {
            forecaster: forecaster.into(),
            source: source.into(),
        }
    }
}

/// Forecasts cannot be scored.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the messages describe the fields")]
pub enum EvaluationError {
    #[error("no window to score; is the test set empty?")]
    NoWindows,
    #[error("{windows} windows but {forecasts} forecasts; each window needs one forecast")]
    Count { windows: usize, forecasts: usize },
    #[error("{longest} true positions after the observation; a forecast has {HORIZON}")]
    Seen { longest: usize },
    #[error("{windows} windows but {full_windows} full ones; each window needs its full one")]
    FullWindowCount { windows: usize, full_windows: usize },
    #[error("window of `{recording}` starting at frame {start_frame}{problem}")]
    Window {
        recording: String,
        start_frame: i64,
        problem: WindowProblem,
    },
}

/// Why a window cannot be scored with its forecast; the messages follow the name of the window.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the messages describe the fields")]
pub enum WindowProblem {
    #[error(" holds {expected} pedestrians, its forecast {found}")]
    Pedestrians { expected: usize, found: usize },
    #[error(": its full window has other frames or lacks some of its pedestrians")]
    FullWindow,
    #[error(" has no true future: it can be forecast but not scored")]
    NoFuture,
    #[error(" was forecast with {found} hypotheses, the windows before it with {expected}; the best of K needs one K")]
    Hypotheses { expected: usize, found: usize },
    #[error(": all forecasts of a test set must have certificates, or none")]
    CertificatesOfSome,
    #[error(": all forecasts of a test set must have goals, or none")]
    GoalsOfSome,
}

impl EvaluationError {
    /// A problem of one window.
    pub fn of(window: &Window, problem: WindowProblem) -> Self {
        Self::Window {
            recording: window.recording().to_owned(),
            start_frame: window.start_frame(),
            problem,
        }
    }

    /// Checks that there is one forecast for each window.
    pub(crate) fn unless_one_each(windows: &[Window], forecasts: usize) -> Result<(), Self> {
        let windows = windows.len();
        if windows == forecasts {
            return Ok(());
        }
        Err(Self::Count { windows, forecasts })
    }
}

/// A forecaster cannot be measured.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MeasureError {
    /// Its forecast failed.
    #[error(transparent)]
    Forecast(#[from] ForecastError),
    /// Its forecasts cannot be scored.
    #[error(transparent)]
    Evaluation(#[from] EvaluationError),
}
