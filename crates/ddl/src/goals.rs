//! Goals of whole windows: the estimator as the network and the baselines need it.

use ddl_data::{Position, Window};
use ddl_eval::ForecastError;
use ddl_eval::baseline::{GoalSource, WeightedGoals};
use ddl_goal::{GoalEstimator, GoalSet};

/// The goal sets of every pedestrian of every window.
///
/// The estimator sees the observed positions alone, unless it is the published one, whose query
/// reads one future position.
///
/// # Errors
/// When a window is shorter than the estimator's query.
pub(crate) fn of_windows(
    estimator: &GoalEstimator,
    windows: &[Window],
) -> Result<Vec<Vec<GoalSet>>, ForecastError> {
    let needed = estimator.params().query().positions();
    let mut tracks: Vec<&[Position]> = Vec::new();
    for window in windows {
        if window.track(0).len() < needed {
            return Err(ForecastError::FutureMissing {
                forecaster: "goal estimator".into(),
                recording: window.recording().to_owned(),
                start_frame: window.start_frame(),
            });
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

/// All estimated goals with their weights: what `fair` and `single` may use.
#[derive(Debug)]
pub(crate) struct EstimatedGoals<'a>(pub(crate) &'a GoalEstimator);

impl GoalSource for EstimatedGoals<'_> {
    fn name(&self) -> String {
        "the estimated goals".into()
    }

    fn goals(&self, window: &Window) -> Result<Vec<WeightedGoals>, ForecastError> {
        of_windows(self.0, std::slice::from_ref(window))?
            .into_iter()
            .flatten()
            .map(|set| {
                Ok(WeightedGoals::new(
                    set.goals().to_vec(),
                    set.weights().to_vec(),
                )?)
            })
            .collect()
    }
}

/// The one estimated goal nearest the TRUE end: the published protocol's oracle.
#[derive(Debug)]
pub(crate) struct OracleGoals<'a>(pub(crate) &'a GoalEstimator);

impl OracleGoals<'_> {
    /// One goal a pedestrian.
    pub(crate) fn of_windows(
        &self,
        windows: &[Window],
    ) -> Result<Vec<Vec<Position>>, ForecastError> {
        let sets = of_windows(self.0, windows)?;
        windows
            .iter()
            .zip(sets)
            .map(|(window, sets)| {
                let nearest = |(i, set): (usize, &GoalSet)| {
                    window.end(i).map(|end| set.goals()[set.nearest(end)])
                };
                sets.iter()
                    .enumerate()
                    .map(nearest)
                    .collect::<Option<_>>()
                    .ok_or_else(|| ForecastError::FutureMissing {
                        forecaster: self.name(),
                        recording: window.recording().to_owned(),
                        start_frame: window.start_frame(),
                    })
            })
            .collect()
    }
}

impl GoalSource for OracleGoals<'_> {
    fn name(&self) -> String {
        "the estimated goal nearest the TRUE end".into()
    }

    fn goals(&self, window: &Window) -> Result<Vec<WeightedGoals>, ForecastError> {
        let goals = self.of_windows(std::slice::from_ref(window))?;
        Ok(goals
            .into_iter()
            .flatten()
            .map(WeightedGoals::certain)
            .collect())
    }
}
