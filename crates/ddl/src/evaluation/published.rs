//! The model under the published protocol. It is kept separate because it uses the true future.

use crate::error::DdlError;
use crate::evaluation::parts::{parts, pedestrians, scored};
use crate::forecast::certified::Walked;
use crate::forecast::name;
use crate::forecast::shaped;
use crate::goals::sets;
use crate::model::ddl::Ddl;
use crate::run::directory::RunDirectory;
use ddl_core::{Forecast, ForecastError, Position, Setting, Window};
use ddl_eval::Scores;
use ddl_goal::GoalEstimator;
use ddl_network::{ForecastWindows, NetworkFrame, Noise, StepRule};
use std::path::PathBuf;

/// Noise samples for the goal of a pedestrian.
const SAMPLES: usize = 20;

/// A network, its goals and its noise. The goal of each pedestrian is the one nearest the TRUE end.
pub(crate) struct OracleVariant<'a> {
    pub(crate) network: &'a Published,
    /// Index of the estimator of its goals.
    pub(crate) estimator: usize,
    pub(crate) noise: Noise,
    /// The difference from the published protocol.
    pub(crate) change: Option<&'static str>,
}

/// The model as the published code evaluates it: noise samples to the estimated goal nearest the TRUE endpoint, with
/// plain Euler steps.
#[derive(Debug)]
pub(crate) struct Published {
    network: Box<dyn ForecastWindows>,
    /// The noise of the published protocol.
    pub(crate) samples: Noise,
}

impl Published {
    /// Returns the kept epoch that is best on these TEST windows, and the last one. The published code chooses the
    /// former; a fair evaluation must not. `report` receives the number of pedestrians after each part.
    pub(crate) fn best_on_test_and_last(
        model: &Ddl,
        estimator: &GoalEstimator,
        windows: &[Window],
        mut report: impl FnMut(usize) -> Result<(), DdlError>,
    ) -> Result<[Self; 2], DdlError> {
        let Some(run) = model.run() else {
            return Err(model.source().wrong(
            "keeps one set of weights, but the protocol `published` chooses among epochs; evaluate it under `fair` and \
             `single`",
            ));
        };
        let samples = Noise::Draws { count: SAMPLES, seed: model.config().training.seed };
        let with = |weights: PathBuf| {
            let network = model.network_with(&weights)?;
            Ok::<_, DdlError>(Self { network, samples })
        };
        let mut goals = Vec::new();
        let mut best = (f64::INFINITY, run.model());
        for epoch in compared_epochs(run)? {
            let candidate = with(run.epoch(epoch))?;
            let mut sum = 0.0;
            for (index, part) in parts(windows).enumerate() {
                if index == goals.len() {
                    goals.push(sets::nearest_true_end(estimator, part)?);
                }
                let forecasts = candidate.forecast_towards(part, &goals[index], candidate.samples)?;
                let forecasts: Vec<Forecast> = scored(part, forecasts).collect();
                sum += Scores::evaluate(part, &forecasts)?.min_ade * pedestrians(part) as f64;
                report(pedestrians(part))?;
            }
            if sum < best.0 {
                best = (sum, run.epoch(epoch));
            }
        }
        Ok([with(best.1)?, with(run.model())?])
    }

    /// Forecasts with this noise for the single goal of every pedestrian. The steps are plain Euler steps. A network
    /// that was trained with bounded steps keeps them, because its output is dimensionless.
    pub(crate) fn forecast_towards(
        &self,
        windows: &[Window],
        goals: &[Vec<Position>],
        noise: Noise,
    ) -> Result<Vec<Forecast>, ForecastError> {
        let config = self.network.config();
        let single: Vec<Vec<Vec<Position>>> =
            goals.iter().map(|goals| goals.iter().map(|&goal| vec![goal]).collect()).collect();
        let rule = match config.frame {
            NetworkFrame::World => StepRule::Euler,
            NetworkFrame::Goal => StepRule::Bounded,
        };
        let rollouts = self
            .network
            .forecast_windows(windows, &single, noise, rule, None)
            .map_err(|error| ForecastError::model(name::NAME, error))?;
        let rolled = rollouts.into_iter().zip(windows).zip(goals);
        rolled
            .map(|((rollout, window), goals)| {
                if !config.variant.uses_goal() {
                    return shaped::with_equal_weights(rollout);
                }
                let samples = rollout.hypotheses;
                let walked = Walked {
                    spread: None,
                    origins: Vec::new(),
                    shares: vec![1.0; window.len()],
                    familiarity: None,
                    config,
                    rule,
                    window,
                    hypotheses: samples,
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

/// The epochs of a run to choose from; none if it was trained for one only.
pub(crate) fn compared_epochs(run: &RunDirectory) -> Result<Vec<usize>, DdlError> {
    let epochs = run.kept_epochs()?;
    match (epochs.len(), run.config()?.training.epochs) {
        (_, 1) => Ok(Vec::new()),
        (0 | 1, _) => Err(DdlError::run(
            run.path(),
            format!(
                "keeps the weights of no epochs that `published` could choose from; train it again, with {}",
                Setting::Patience.to(0)
            ),
        )),
        _ => Ok(epochs),
    }
}
