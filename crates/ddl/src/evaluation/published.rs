//! The model under the published protocol. It is kept separate because it uses the true future.

use crate::error::DdlError;
use crate::forecast::certified::Walked;
use crate::forecast::name;
use crate::forecast::shaped;
use crate::forecast::walk::PathIntegrator;
use crate::goals::sets;
use crate::model::ddl::Ddl;
use ddl_core::{Forecast, ForecastError};
use ddl_data::{Position, Window};
use ddl_eval::Scores;
use ddl_goal::GoalEstimator;
use ddl_network::{ForecastWindows, NetworkFrame, Noise};

const SAMPLES: usize = 20;

/// The model as the published code evaluates it: 20 noise samples to the estimated goal nearest the TRUE endpoint, with
/// plain Euler steps.
#[derive(Debug)]
pub(crate) struct Published {
    network: Box<dyn ForecastWindows>,
    seed: u64,
}

impl Published {
    /// Chooses the saved epoch that is best on the given TEST windows, as the published code does. A fair evaluation
    /// must not do this.
    pub(crate) fn best_on_test(
        model: &Ddl,
        estimator: &GoalEstimator,
        windows: &[Window],
        mut tick: impl FnMut() -> Result<(), DdlError>,
    ) -> Result<Self, DdlError> {
        let Some(run) = model.run() else {
            return Err(model.source().wrong(
            "keeps one set of weights, but the protocol `published` chooses among epochs; evaluate it under `fair` and \
             `single`",
            ));
        };
        let config = model.config();
        // The result is labelled "best kept epoch", so there must be several to choose from.
        if config.training.epochs > 1 && config.keep_every >= config.training.epochs {
            return Err(DdlError::run(
                run.path(),
                "keeps the weights of its last epoch only, but `published` chooses among several; train it again \
                 without --last-epoch-only",
            ));
        }
        if config.patience.is_some() {
            return Err(DdlError::run(
                run.path(),
                "keeps the weights of its best epoch only, chosen on its validation part, but `published` chooses \
                 among several; train it again with --patience 0",
            ));
        }
        let goals = sets::nearest_true_end(estimator, windows)?;
        let mut best: Option<(f64, Self)> = None;
        for epoch in run.kept_epochs()? {
            tick()?;
            let network = model.network_of_epoch(run, epoch)?;
            let candidate = Self {
                network,
                seed: model.config().training.seed,
            };
            let forecasts = candidate.forecast_towards(windows, &goals)?;
            let error = Scores::evaluate(windows, &forecasts)?.min_ade;
            if best.as_ref().is_none_or(|(least, _)| error < *least) {
                best = Some((error, candidate));
            }
        }
        let (_, best) = best.ok_or_else(|| DdlError::run(run.path(), "has no saved epochs; train it again"))?;
        Ok(best)
    }

    /// Makes 20 noise samples for the single goal of every pedestrian. The steps are plain Euler steps. A network that
    /// was trained with bounded steps keeps them, because its output is dimensionless.
    pub(crate) fn forecast_towards(
        &self,
        windows: &[Window],
        goals: &[Vec<Position>],
    ) -> Result<Vec<Forecast>, ForecastError> {
        let config = self.network.config();
        let single: Vec<Vec<Vec<Position>>> = goals
            .iter()
            .map(|goals| goals.iter().map(|&goal| vec![goal]).collect())
            .collect();
        let noise = Noise::Draws {
            count: SAMPLES,
            seed: self.seed,
        };
        let integrator = match config.frame {
            NetworkFrame::World => PathIntegrator::PlainEuler,
            NetworkFrame::Goal => PathIntegrator::Stable,
        };
        let rollouts = self
            .network
            .forecast_windows(windows, &single, noise, integrator.rule(), None)
            .map_err(|error| ForecastError::model(name::NAME, error))?;
        let rolled = rollouts.into_iter().zip(windows).zip(goals);
        rolled
            .map(|((rollout, window), goals)| {
                if !config.variant.uses_goal() {
                    return shaped::with_equal_weights(rollout);
                }
                let walked = Walked {
                    spread: None,
                    shares: vec![1.0; window.len()],
                    familiarity: None,
                    config,
                    integrator,
                    window,
                    hypotheses: rollout.hypotheses,
                    rolled_out: rollout.positions,
                    factors: rollout.factors,
                    weights: vec![1.0 / SAMPLES as f64; goals.len() * SAMPLES],
                    goals: goals.iter().flat_map(|&goal| [goal; SAMPLES]).collect(),
                };
                walked.forecast()
            })
            .collect()
    }
}
