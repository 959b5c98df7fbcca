//! What can go wrong between a forecast and a printed table.

use ddl_data::{HORIZON, Window};

use crate::Protocol;

/// The numbers given for a [`Forecast`](crate::Forecast) do not make one.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ForecastShapeError {
    /// A forecast needs at least one pedestrian and one hypothesis.
    #[error(
        "a forecast needs at least one pedestrian and one hypothesis, found {pedestrians} x {hypotheses}"
    )]
    Empty {
        /// Number of pedestrians given.
        pedestrians: usize,
        /// Number of hypotheses given.
        hypotheses: usize,
    },
    /// A flat array has the wrong length.
    #[error("`{field}` must hold {expected} entries ({layout}), found {found}")]
    Length {
        /// The array: `positions`, `weights`, `goals` or `certified`.
        field: &'static str,
        /// What the entries are, in order.
        layout: &'static str,
        /// Entries needed.
        expected: usize,
        /// Entries given.
        found: usize,
    },
    /// A coordinate or a weight is NaN or infinite.
    #[error(
        "`{field}` of pedestrian {pedestrian}, hypothesis {hypothesis} is not finite; \
         a model that diverged must be reported as such, not scored"
    )]
    NotFinite {
        /// The array: `positions`, `weights` or `goals`.
        field: &'static str,
        /// Row of the pedestrian in the window.
        pedestrian: usize,
        /// Index of the hypothesis.
        hypothesis: usize,
    },
    /// A weight is below zero.
    #[error("the weight of pedestrian {pedestrian}, hypothesis {hypothesis} is {weight}, below 0")]
    NegativeWeight {
        /// Row of the pedestrian in the window.
        pedestrian: usize,
        /// Index of the hypothesis.
        hypothesis: usize,
        /// The weight.
        weight: f64,
    },
    /// A spread is not positive, or a familiarity not in (0, 1].
    #[error("the {field} of pedestrian {pedestrian} is {value}, out of range")]
    OutOfRange {
        /// `spread` or `familiarity`.
        field: &'static str,
        /// Row of the pedestrian in the window.
        pedestrian: usize,
        /// The value.
        value: f64,
    },
    /// The weights of a pedestrian do not sum to 1.
    #[error(
        "the weights of pedestrian {pedestrian} sum to {sum}, not to 1; divide them by their sum"
    )]
    NotNormalised {
        /// Row of the pedestrian in the window.
        pedestrian: usize,
        /// Sum of the weights given.
        sum: f64,
    },
}

/// A forecaster could not make its forecast.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ForecastError {
    /// The numbers produced do not make a forecast.
    #[error(transparent)]
    Shape(#[from] ForecastShapeError),
    /// The forecaster reads the true future and the window has none.
    #[error(
        "`{forecaster}` reads the true future, which the window of `{recording}` starting at frame \
         {start_frame} does not show (protocols `fair` and `single` never show it)"
    )]
    FutureMissing {
        /// Name of the forecaster or goal source.
        forecaster: String,
        /// Name of the recording.
        recording: String,
        /// First frame of the window.
        start_frame: i64,
    },
    /// A goal source gave goals for the wrong number of pedestrians, or sets of different sizes.
    #[error("goal source `{goal_source}`: {problem}")]
    Goals {
        /// Name of the goal source.
        goal_source: String,
        /// What is wrong.
        problem: String,
    },
    /// More hypotheses than the protocol allows.
    #[error(
        "protocol `{protocol}` allows {allowed} hypotheses a pedestrian, `{forecaster}` made {found}"
    )]
    TooManyHypotheses {
        /// The protocol.
        protocol: Protocol,
        /// Name of the forecaster.
        forecaster: String,
        /// Hypotheses allowed.
        allowed: usize,
        /// Hypotheses made.
        found: usize,
    },
    /// The model itself failed.
    #[error("`{forecaster}` failed")]
    Model {
        /// Name of the forecaster.
        forecaster: String,
        /// The model's own error.
        source: Box<dyn std::error::Error + Send + Sync>,
    },
}

impl ForecastError {
    /// Wraps the error of a model.
    pub fn model(
        forecaster: impl Into<String>,
        source: impl Into<Box<dyn std::error::Error + Send + Sync>>,
    ) -> Self {
        Self::Model {
            forecaster: forecaster.into(),
            source: source.into(),
        }
    }
}

/// Forecasts cannot be scored.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum EvaluationError {
    /// Nothing to score.
    #[error("there is no window to score; is the test set empty?")]
    NoWindows,
    /// Not one forecast a window.
    #[error("{windows} windows but {forecasts} forecasts; there must be one forecast a window")]
    Count {
        /// Number of windows.
        windows: usize,
        /// Number of forecasts.
        forecasts: usize,
    },
    /// More was seen of a pedestrian's future than a forecast covers.
    #[error(
        "{longest} positions were given as seen after the observation; a forecast covers {HORIZON}"
    )]
    Seen {
        /// Positions of the pedestrian with the most.
        longest: usize,
    },
    /// Not one whole window for each reduced one.
    #[error("{windows} windows but {everybody} whole ones; there must be one each")]
    EverybodyCount {
        /// Number of windows.
        windows: usize,
        /// Number of whole windows.
        everybody: usize,
    },
    /// A window cannot be scored with its forecast.
    #[error("window of `{recording}` starting at frame {start_frame}{problem}")]
    Window {
        /// Name of the recording.
        recording: String,
        /// First frame of the window.
        start_frame: i64,
        /// Why.
        problem: WindowProblem,
    },
}

/// Why a window cannot be scored with its forecast; what follows the name of the window in messages.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum WindowProblem {
    /// The forecast is of other people than the window holds.
    #[error(" holds {expected} pedestrians, its forecast {found}")]
    Pedestrians {
        /// Pedestrians in the window.
        expected: usize,
        /// Pedestrians in the forecast.
        found: usize,
    },
    /// A reduced window is not a part of the whole one it is scored among.
    #[error(": the whole window given is of other frames or lacks some of its pedestrians")]
    Everybody,
    /// The window has no future to compare with.
    #[error(" has no true future: it can be forecast but not scored")]
    NoFuture,
    /// Windows were forecast with different numbers of hypotheses.
    #[error(
        " was forecast with {found} hypotheses, the windows before it with {expected}; the best of K needs one K"
    )]
    Hypotheses {
        /// Hypotheses of the first window.
        expected: usize,
        /// Hypotheses of this window.
        found: usize,
    },
    /// Only some of the forecasts have certificates.
    #[error(": either every forecast of a test set carries certificates or none does")]
    CertificatesOfSome,
    /// Only some of the forecasts have goals.
    #[error(": either every forecast of a test set has goals or none has")]
    GoalsOfSome,
}

impl EvaluationError {
    /// What is wrong with a window.
    #[must_use]
    pub fn of(window: &Window, problem: WindowProblem) -> Self {
        Self::Window {
            recording: window.recording().to_owned(),
            start_frame: window.start_frame(),
            problem,
        }
    }

    /// That there is one forecast a window.
    pub(crate) fn unless_one_each(windows: &[Window], forecasts: usize) -> Result<(), Self> {
        let windows = windows.len();
        if windows == forecasts {
            return Ok(());
        }
        Err(Self::Count { windows, forecasts })
    }
}

/// A forecaster could not be measured.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MeasureError {
    /// It could not forecast.
    #[error(transparent)]
    Forecast(#[from] ForecastError),
    /// Its forecasts could not be scored.
    #[error(transparent)]
    Evaluation(#[from] EvaluationError),
}
