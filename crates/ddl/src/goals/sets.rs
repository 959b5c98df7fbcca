//! Goals of whole windows, for the network and the straight-line forecasts.

use ddl_core::{ForecastError, Position, Window};
use ddl_goal::{GoalEstimator, GoalSet};
use rayon::prelude::*;

/// The retrieved goal sets of every pedestrian of every window.
///
/// The estimator reads the observed positions only. The published one also reads one future position.
pub(crate) fn retrieved(estimator: &GoalEstimator, windows: &[Window]) -> Result<Vec<Vec<GoalSet>>, ForecastError> {
    let needed = estimator.params().query.positions();
    let mut tracks: Vec<&[Position]> = Vec::new();
    for window in windows {
        if window.steps() < needed {
            return Err(future_missing(window));
        }
        tracks.extend((0..window.len()).map(|i| &window.track(i)[..needed]));
    }
    let sets = estimator.estimate_batch(&tracks).map_err(|error| ForecastError::model("goal estimator", error))?;
    let mut sets = sets.into_iter();
    Ok(windows.iter().map(|window| sets.by_ref().take(window.len()).collect()).collect())
}

/// The central goal of each pedestrian. Padded positions before the first observation extrapolate in a straight line,
/// so they do not show how steady a motion is.
pub(crate) fn with_central_only(windows: &[Window], sets: &[Vec<GoalSet>]) -> Vec<Vec<GoalSet>> {
    let of_window = |(window, sets): (&Window, &Vec<GoalSet>)| {
        let pedestrians = sets.par_iter().enumerate();
        pedestrians.map(|(i, set)| set.with_central_only(&window.observed(i)[window.quality(i).unseen..])).collect()
    };
    windows.iter().zip(sets).map(of_window).collect()
}

/// For each pedestrian, the estimated goal nearest the TRUE endpoint: the oracle of the published protocol.
pub(crate) fn nearest_true_end(
    estimator: &GoalEstimator,
    windows: &[Window],
) -> Result<Vec<Vec<Position>>, ForecastError> {
    let of_window = |(window, sets): (&Window, Vec<GoalSet>)| {
        let nearest = |(i, set): (usize, &GoalSet)| {
            let end = window.end(i).ok_or_else(|| future_missing(window))?;
            Ok(set.goals()[set.nearest(end)])
        };
        sets.iter().enumerate().map(nearest).collect()
    };
    windows.iter().zip(retrieved(estimator, windows)?).map(of_window).collect()
}

fn future_missing(window: &Window) -> ForecastError {
    ForecastError::FutureMissing {
        forecaster: "goal estimator of the published protocol".into(),
        recording: window.recording().to_owned(),
        start_frame: window.start_frame(),
    }
}
