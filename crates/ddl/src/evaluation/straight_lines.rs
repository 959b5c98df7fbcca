//! Straight lines to known goals: the baseline that shows what the dynamics add.

use ddl_core::{Forecast, ForecastError, Forecaster as _, WeightedGoals};
use ddl_data::Window;
use ddl_eval::baseline::{GoalSource, StraightLine};
use ddl_goal::GoalSet;

pub(crate) fn straight_lines(
    name: &'static str,
    windows: &[Window],
    goals: &[Vec<WeightedGoals>],
) -> Result<Vec<Forecast>, ForecastError> {
    windows
        .iter()
        .zip(goals)
        .map(|(window, goals)| StraightLine(KnownGoals { name, goals }).forecast(window))
        .collect()
}

struct KnownGoals<'a> {
    name: &'static str,
    goals: &'a [WeightedGoals],
}

impl GoalSource for KnownGoals<'_> {
    fn name(&self) -> String {
        self.name.to_owned()
    }

    fn goals(&self, _window: &Window) -> Result<Vec<WeightedGoals>, ForecastError> {
        Ok(self.goals.to_vec())
    }
}

/// Goal sets in the form that the baselines of the evaluation take.
pub(crate) fn weighted(sets: &[Vec<GoalSet>]) -> Result<Vec<Vec<WeightedGoals>>, ForecastError> {
    let one = |set: &GoalSet| WeightedGoals::new(set.goals().to_vec(), set.weights().to_vec());
    sets.iter()
        .map(|sets| Ok(sets.iter().map(one).collect::<Result<_, _>>()?))
        .collect()
}
