//! Straight lines to known goals: the baseline that shows what the dynamics add.

use ddl_core::{Forecast, ForecastError, Forecaster as _};
use ddl_data::Window;
use ddl_eval::baseline::{GoalSource, StraightLine, WeightedGoals};

pub(crate) fn straight_lines(
    name: &'static str,
    windows: &[Window],
    goals: &[Vec<WeightedGoals>],
) -> Result<Vec<Forecast>, ForecastError> {
    windows
        .iter()
        .zip(goals)
        .map(|(window, goals)| StraightLine::to(KnownGoals { name, goals }).forecast(window))
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
