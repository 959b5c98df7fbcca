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

/// Windows that the choice of an epoch forecasts between two reports.
const WINDOWS_AT_ONCE: usize = 32;
/// Noise samples for the goal of a pedestrian.
pub(crate) const SAMPLES: usize = 20;

/// The model as the published code evaluates it: noise samples to the estimated goal nearest the TRUE endpoint, with
/// plain Euler steps.
#[derive(Debug)]
pub(crate) struct Published {
    network: Box<dyn ForecastWindows>,
    seed: u64,
}

impl Published {
    /// The saved epoch that is best on the given TEST windows, which the published code chooses and a fair evaluation
    /// must not; and the last one.
    pub(crate) fn best_on_test_and_last<'a>(
        model: &Ddl,
        estimator: &GoalEstimator,
        windows: impl Iterator<Item = &'a Window>,
        mut done: impl FnMut(&[Window]) -> Result<(), DdlError>,
    ) -> Result<[Self; 2], DdlError> {
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
        let windows: Vec<Window> = windows.cloned().collect();
        let goals = sets::nearest_true_end(estimator, &windows)?;
        let of_epoch = |epoch| {
            let network = model.network_of_epoch(run, epoch)?;
            let seed = config.training.seed;
            Ok::<_, DdlError>(Self { network, seed })
        };
        let epochs = run.kept_epochs()?;
        let Some(&last) = epochs.last() else {
            return Err(DdlError::run(run.path(), "has no saved epochs; train it again"));
        };
        let mut best = (f64::INFINITY, last);
        for epoch in epochs {
            let network = of_epoch(epoch)?;
            let mut forecasts = Vec::new();
            for (windows, goals) in windows.chunks(WINDOWS_AT_ONCE).zip(goals.chunks(WINDOWS_AT_ONCE)) {
                forecasts.extend(network.forecast_towards(windows, goals, SAMPLES)?);
                done(windows)?;
            }
            let error = Scores::evaluate(&windows, &forecasts)?.min_ade;
            if error < best.0 {
                best = (error, epoch);
            }
        }
        Ok([of_epoch(best.1)?, of_epoch(last)?])
    }

    /// Makes noise samples for the single goal of every pedestrian. The steps are plain Euler steps. A network that
    /// was trained with bounded steps keeps them, because its output is dimensionless.
    pub(crate) fn forecast_towards(
        &self,
        windows: &[Window],
        goals: &[Vec<Position>],
        samples: usize,
    ) -> Result<Vec<Forecast>, ForecastError> {
        let config = self.network.config();
        let single: Vec<Vec<Vec<Position>>> = goals
            .iter()
            .map(|goals| goals.iter().map(|&goal| vec![goal]).collect())
            .collect();
        let noise = Noise::Draws {
            count: samples,
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
                    weights: vec![1.0 / samples as f64; goals.len() * samples],
                    goals: goals.iter().flat_map(|&goal| vec![goal; samples]).collect(),
                };
                walked.forecast()
            })
            .collect()
    }
}
