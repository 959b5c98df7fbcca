//! The published protocol's forecaster, kept apart because it reads the truth.

use crate::DdlError;
use crate::goals::OracleGoals;
use crate::model::{Ddl, forecast, unused_goals};
use ddl_data::{Position, Window};
use ddl_eval::{Forecast, ForecastError, Forecaster, Protocol, Scores};
use ddl_goal::GoalEstimator;
use ddl_star::{Integrator, Noise, StarNetwork};

/// Noise samples on the one goal.
const SAMPLES: usize = 20;

/// The model as the published code measures it: the estimated goal nearest the TRUE end, then 20
/// noise samples on that goal, plain Euler steps.
#[derive(Debug)]
pub(crate) struct Published<'a> {
    network: StarNetwork,
    estimator: &'a GoalEstimator,
    seed: u64,
}

impl<'a> Published<'a> {
    /// The epoch that is best on the given TEST windows, of those kept: as the published code
    /// chooses, and as no honest evaluation may.
    pub(crate) fn best_on_test(
        model: &Ddl,
        estimator: &'a GoalEstimator,
        windows: &[Window],
        mut tick: impl FnMut() -> Result<(), DdlError>,
    ) -> Result<Self, DdlError> {
        let mut best: Option<(f64, Self)> = None;
        for epoch in model.run().kept_epochs()? {
            tick()?;
            let candidate = Self {
                network: model.network_of_epoch(epoch)?,
                estimator,
                seed: model.config().training.seed,
            };
            let forecasts = Protocol::Published.forecast(&candidate, windows)?;
            let error = Scores::evaluate(windows, &forecasts)?.min_ade;
            if best.as_ref().is_none_or(|(least, _)| error < *least) {
                best = Some((error, candidate));
            }
        }
        let (_, forecaster) = best.ok_or_else(|| {
            DdlError::run(
                model.run().path(),
                "keeps the weights of no epoch; train it anew",
            )
        })?;
        Ok(forecaster)
    }
}

impl Forecaster for Published<'_> {
    fn name(&self) -> String {
        "DDL".into()
    }

    fn forecast(&self, window: &Window) -> Result<Forecast, ForecastError> {
        let mut forecasts = self.forecast_all(std::slice::from_ref(window))?;
        // one window in, one forecast out
        Ok(forecasts.remove(0))
    }

    fn forecast_all(&self, windows: &[Window]) -> Result<Vec<Forecast>, ForecastError> {
        let with_goals = self.network.config().variant.uses_goal();
        let goals: Vec<Vec<Vec<Position>>> = if with_goals {
            let goals = OracleGoals(self.estimator).of_windows(windows)?;
            goals
                .into_iter()
                .map(|goals| goals.into_iter().map(|goal| vec![goal]).collect())
                .collect()
        } else {
            unused_goals(windows)
        };
        let noise = Noise::Draws {
            count: SAMPLES,
            seed: self.seed,
        };
        let rollouts = self
            .network
            .forecast_windows(windows, &goals, noise, Integrator::Euler)
            .map_err(|error| ForecastError::model(self.name(), error))?;
        rollouts
            .into_iter()
            .zip(goals)
            .map(|(rollout, goals)| {
                let repeated = goals.iter().flat_map(|goal| [goal[0]; SAMPLES]).collect();
                forecast(rollout, None, with_goals.then_some(repeated))
            })
            .collect()
    }
}
