//! Errors of scoring.

use ddl_core::{ForecastError, HORIZON, Window};

/// Forecasts cannot be made or scored.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the messages describe the fields")]
pub enum EvaluationError {
    #[error(transparent)]
    Forecast(#[from] ForecastError),
    #[error("no window to score; is the test set empty?")]
    NoWindows,
    #[error("{windows} windows but {forecasts} forecasts; each window needs one forecast")]
    Count { windows: usize, forecasts: usize },
    #[error("{longest} true positions after the observation; a forecast has {HORIZON}")]
    Seen { longest: usize },
    #[error("{windows} windows but {full_windows} full ones; each window needs its full one")]
    FullWindowCount { windows: usize, full_windows: usize },
    #[error("window of `{recording}` starting at frame {start_frame}{problem}")]
    Window { recording: String, start_frame: i64, problem: WindowProblem },
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
    pub fn in_window(window: &Window, problem: WindowProblem) -> Self {
        Self::Window { recording: window.recording().to_owned(), start_frame: window.start_frame(), problem }
    }

    /// Checks that a forecast, or what else is known of a window, has as many pedestrians.
    ///
    /// # Errors
    /// [`WindowProblem::Pedestrians`].
    pub fn unless_same_pedestrians(window: &Window, found: usize) -> Result<(), Self> {
        let expected = window.len();
        if expected == found {
            return Ok(());
        }
        Err(Self::in_window(window, WindowProblem::Pedestrians { expected, found }))
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
