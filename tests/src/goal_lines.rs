//! Straight lines to estimated goals: the goal estimator of `ddl-goal` behind the baseline of
//! `ddl-eval`, as a forecaster that needs no network.

use ddl_data::Window;
use ddl_eval::ForecastError;
use ddl_eval::baseline::{GoalSource, StraightLine, WeightedGoals};
use ddl_goal::GoalEstimator;

/// The goals of an estimator, shown whole tracks: what it reads of them is its own affair.
#[derive(Debug)]
pub struct EstimatedGoals(pub GoalEstimator);

impl GoalSource for EstimatedGoals {
    fn name(&self) -> String {
        "the estimated goals".to_owned()
    }

    fn goals(&self, window: &Window) -> Result<Vec<WeightedGoals>, ForecastError> {
        let tracks: Vec<_> = (0..window.len()).map(|i| window.track(i)).collect();
        let sets = self
            .0
            .estimate_batch(&tracks)
            .map_err(|error| ForecastError::model("goal estimator", error))?;
        sets.iter()
            .map(|set| {
                Ok(WeightedGoals::new(
                    set.goals().to_vec(),
                    set.weights().to_vec(),
                )?)
            })
            .collect()
    }
}

/// Straight lines to the goals of `estimator`.
#[must_use]
pub fn to_goals_of(estimator: GoalEstimator) -> StraightLine<EstimatedGoals> {
    StraightLine::to(EstimatedGoals(estimator))
}
