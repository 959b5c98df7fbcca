//! Straight lines to known goals: the baseline that shows what the dynamics add.

use ddl_core::{Forecast, ForecastError, Forecaster as _, WeightedGoals, Window};
use ddl_eval::baseline::StraightLine;
use ddl_goal::GoalSet;

pub(crate) fn straight_lines(
    windows: &[Window],
    goals: Vec<Vec<WeightedGoals>>,
) -> Result<Vec<Forecast>, ForecastError> {
    windows.iter().zip(goals).map(|(window, goals)| StraightLine(goals).forecast(window)).collect()
}

/// Goal sets in the form that the baselines of the evaluation take.
pub(crate) fn weighted(sets: &[Vec<GoalSet>]) -> Result<Vec<Vec<WeightedGoals>>, ForecastError> {
    let one = |set: &GoalSet| WeightedGoals::new(set.goals().to_vec(), set.weights().to_vec());
    sets.iter().map(|sets| Ok(sets.iter().map(one).collect::<Result<_, _>>()?)).collect()
}
