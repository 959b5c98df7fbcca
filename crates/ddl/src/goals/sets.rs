//! Goals of whole windows, as the network and the straight lines need them.

use ddl_data::{Position, Window};
use ddl_eval::ForecastError;
use ddl_eval::baseline::WeightedGoals;
use ddl_goal::{GoalEstimator, GoalSet};

/// The retrieved goal sets of every pedestrian of every window.
///
/// The estimator sees the observed positions alone, unless it is the published one, whose query
/// reads one future position.
pub(crate) fn retrieved(
    estimator: &GoalEstimator,
    windows: &[Window],
) -> Result<Vec<Vec<GoalSet>>, ForecastError> {
    let needed = estimator.params().query.positions();
    let mut tracks: Vec<&[Position]> = Vec::new();
    for window in windows {
        if window.steps() < needed {
            return Err(future_missing(window));
        }
        tracks.extend((0..window.len()).map(|i| &window.track(i)[..needed]));
    }
    let sets = estimator
        .estimate_batch(&tracks)
        .map_err(|error| ForecastError::model("goal estimator", error))?;
    let mut sets = sets.into_iter();
    Ok(windows
        .iter()
        .map(|window| sets.by_ref().take(window.len()).collect())
        .collect())
}

/// Goal sets as the evaluation's baselines take them.
pub(crate) fn weighted(sets: &[Vec<GoalSet>]) -> Result<Vec<Vec<WeightedGoals>>, ForecastError> {
    let one = |set: &GoalSet| WeightedGoals::new(set.goals().to_vec(), set.weights().to_vec());
    sets.iter()
        .map(|sets| Ok(sets.iter().map(one).collect::<Result<_, _>>()?))
        .collect()
}

/// The central goal of each pedestrian. Positions before a pedestrian was first seen continue the
/// first ones seen in a straight line: they say nothing of how even a motion is.
pub(crate) fn only_central(windows: &[Window], sets: &[Vec<GoalSet>]) -> Vec<Vec<GoalSet>> {
    let of_window = |(window, sets): (&Window, &Vec<GoalSet>)| {
        let pedestrians = sets.iter().enumerate();
        pedestrians
            .map(|(i, set)| set.only_central(&window.observed(i)[window.made_up(i).padded..]))
            .collect()
    };
    windows.iter().zip(sets).map(of_window).collect()
}

/// The one estimated goal nearest the TRUE end, a pedestrian: the published protocol's oracle.
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
    windows
        .iter()
        .zip(retrieved(estimator, windows)?)
        .map(of_window)
        .collect()
}

fn future_missing(window: &Window) -> ForecastError {
    ForecastError::FutureMissing {
        forecaster: "goal estimator of the published protocol".into(),
        recording: window.recording().to_owned(),
        start_frame: window.start_frame(),
    }
}
