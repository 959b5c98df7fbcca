//! A window with its forecast, checked against each other: the input of every metric.

use ddl_core::{Forecast, OBSERVED, PedestrianId, Position, Window};

use crate::error::{EvaluationError, WindowProblem};

/// A window with a true future and the forecast of its pedestrians, among all pedestrians of the scene.
#[derive(Debug, Clone, Copy)]
pub struct ScoredWindow<'a> {
    window: &'a Window,
    forecast: &'a Forecast,
    full_window: &'a Window,
}

impl<'a> ScoredWindow<'a> {
    /// Pairs a window with its forecast.
    ///
    /// # Errors
    /// The window has no future, or the forecast has another number of pedestrians.
    pub fn new(window: &'a Window, forecast: &'a Forecast) -> Result<Self, EvaluationError> {
        if !window.has_future() {
            return Err(EvaluationError::in_window(window, WindowProblem::NoFuture));
        }
        EvaluationError::unless_same_pedestrians(window, forecast.pedestrians())?;
        Ok(Self { window, forecast, full_window: window })
    }

    /// Sets `full`, the window with all pedestrians of these frames. Metrics that use the true futures of others
    /// take them from it.
    ///
    /// # Errors
    /// `full` has no future, is of other frames or another recording, or lacks a pedestrian of the window.
    pub(crate) fn among(self, full: &'a Window) -> Result<Self, EvaluationError> {
        let window = self.window;
        let same_frames = window.recording() == full.recording() && window.frames() == full.frames();
        if !same_frames || indices_in_full(window, full).is_none() {
            return Err(EvaluationError::in_window(window, WindowProblem::FullWindow));
        }
        Ok(Self { full_window: full, ..self })
    }

    /// The window.
    pub fn window(&self) -> &'a Window {
        self.window
    }

    /// The window with all pedestrians, forecast or not.
    pub(crate) fn full_window(&self) -> &'a Window {
        self.full_window
    }

    /// Index of pedestrian `i` in [`full_window`](Self::full_window).
    pub(crate) fn index_in_full(&self, i: usize) -> usize {
        // `among` has checked that the full window includes them; in the window itself the index is the same.
        index_of(self.full_window, self.window.pedestrians()[i]).unwrap_or(i)
    }

    /// The forecast.
    pub fn forecast(&self) -> &'a Forecast {
        self.forecast
    }

    /// Number of pedestrians, N.
    pub(crate) fn pedestrians(&self) -> usize {
        self.forecast.pedestrians()
    }

    /// Number of hypotheses, K.
    pub(crate) fn hypotheses(&self) -> usize {
        self.forecast.hypotheses()
    }

    /// The 12 true positions of pedestrian `i`, metres.
    pub fn truth(&self, i: usize) -> &'a [Position] {
        self.window.future(i)
    }

    /// The last observed position of pedestrian `i`, metres.
    pub(crate) fn last_observed(&self, i: usize) -> Position {
        self.window.observed(i)[OBSERVED - 1]
    }

    /// The weights of pedestrian `i`, divided by their sum; `[K]`.
    pub(crate) fn weights(&self, i: usize) -> Vec<f64> {
        let weights = (0..self.hypotheses()).map(|k| self.forecast.weight(i, k));
        let sum: f64 = weights.clone().sum();
        weights.map(|weight| weight / sum).collect()
    }

    /// Positions of the hypotheses of pedestrian `i` at forecast frame `t`, counted from 0; `[K]`, metres.
    pub(crate) fn hypotheses_at(&self, i: usize, t: usize) -> Vec<Position> {
        (0..self.hypotheses()).map(|k| self.forecast.hypothesis(i, k)[t]).collect()
    }
}

fn index_of(window: &Window, pedestrian: PedestrianId) -> Option<usize> {
    window.pedestrians().iter().position(|&p| p == pedestrian)
}

pub(crate) fn indices_in_full(window: &Window, full: &Window) -> Option<Vec<usize>> {
    window.pedestrians().iter().map(|&p| index_of(full, p)).collect()
}
