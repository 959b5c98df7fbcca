//! Selection of windows to show (moments), evenly spread over a fold.

use crate::snapshot::ForecastSnapshot;
use ddl_core::{Forecast, Window};
use ddl_eval::EvaluationError;
use std::collections::{BTreeMap, BTreeSet};

/// Number of evenly spread moments of each recording.
const MOMENTS_A_RECORDING: usize = 8;
/// Chooses moments to show from the forecasts of one fold (one forecast for each window), in order of recording and
/// time: 8 of each recording.
///
/// # Errors
/// A window has no future, or a forecast is not of its window's pedestrians.
pub fn moments(
    fold: &str,
    forecaster: &str,
    windows: &[Window],
    forecasts: &[Forecast],
) -> Result<Vec<ForecastSnapshot>, EvaluationError> {
    if windows.len() != forecasts.len() {
        let (windows, forecasts) = (windows.len(), forecasts.len());
        return Err(EvaluationError::Count { windows, forecasts });
    }
    let snapshot = |index: usize| ForecastSnapshot::new(fold, forecaster, &windows[index], &forecasts[index]);
    spread_over_time(windows).into_iter().map(snapshot).collect()
}

/// Indices of windows spread evenly over each recording: the middles of 8 equal parts.
fn spread_over_time(windows: &[Window]) -> BTreeSet<usize> {
    let mut of_recording: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
    for (index, window) in windows.iter().enumerate() {
        of_recording.entry(window.recording()).or_default().push(index);
    }
    of_recording
        .values()
        .flat_map(|indices| {
            (0..MOMENTS_A_RECORDING).map(|part| indices[(2 * part + 1) * indices.len() / (2 * MOMENTS_A_RECORDING)])
        })
        .collect()
}
