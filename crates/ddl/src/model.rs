//! A trained model: the network, its goal estimator, and how the two make a forecast.

use crate::run_directory::{RunConfig, RunDirectory};
use crate::{DdlError, GoalModel};
use ddl_data::{Position, Window};
use ddl_eval::{Forecast, ForecastError, Forecaster};
use ddl_goal::GoalSet;
use ddl_star::{ComputeDevice, Integrator, Noise, StarNetwork, WindowRollout, load_parameters};
use std::path::Path;

/// Hypotheses of the variant without goals: as many noise vectors.
const NOISE_HYPOTHESES: usize = 20;

/// A trained model, ready to forecast.
///
/// As a [`Forecaster`] it is the model of the protocols `fair` and `single`: one hypothesis for each
/// of the K = 20 goals, weighted as the goals are, each rolled out along a flow whose distance to the
/// goal falls at every step. It reads the 8 observed frames and nothing else.
///
/// # Examples
/// ```no_run
/// use ddl::{Ddl, DeviceChoice, Forecaster as _};
/// # fn example(window: &ddl::data::Window) -> Result<(), Box<dyn std::error::Error>> {
/// let model = Ddl::load("runs/eth".as_ref(), DeviceChoice::Cpu)?;
/// let forecast = model.forecast(window)?;
/// let likeliest = forecast.hypothesis(0, forecast.most_likely(0)); // 12 positions, metres
/// # Ok(()) }
/// ```
#[derive(Debug)]
pub struct Ddl {
    goals: GoalModel,
    device: ComputeDevice,
    network: StarNetwork,
}

impl Ddl {
    /// Loads the finished run at `path`.
    ///
    /// # Errors
    /// When there is no finished run, one of its files is broken, or the device cannot be had.
    pub fn load(path: &Path, device: ddl_star::DeviceChoice) -> Result<Self, DdlError> {
        let run = RunDirectory::new(path);
        let config = run.config()?;
        if !run.is_trained() {
            let problem = if run.has_goals(&config.goals) {
                "is not finished: its goals are trained, its network is not (no model.safetensors); run \
                 the same `ddl train` command again, without --only-goals, to go on"
            } else {
                "is not finished: it has no model.safetensors; run the same `ddl train` command again to \
                 go on"
            };
            return Err(DdlError::run(path, problem));
        }
        let device = ComputeDevice::open(device)?;
        let network = load_network(&config, device, &run.model())?;
        Ok(Self {
            goals: GoalModel::of_run(run, config, device)?,
            device,
            network,
        })
    }

    /// What decided the model.
    pub fn config(&self) -> &RunConfig {
        self.goals.config()
    }

    /// Where the model lies.
    pub fn run(&self) -> &RunDirectory {
        self.goals.run()
    }

    /// Where it computes.
    pub fn device(&self) -> ComputeDevice {
        self.device
    }

    /// Numbers learned by the forecasting network.
    pub fn parameter_count(&self) -> usize {
        self.network.parameters().count()
    }

    /// Where its goals come from.
    pub fn goal_model(&self) -> &GoalModel {
        &self.goals
    }

    /// The network, with the weights kept after `epoch`.
    pub(crate) fn network_of_epoch(&self, epoch: usize) -> Result<StarNetwork, DdlError> {
        load_network(self.config(), self.device, &self.run().epoch(epoch))
    }

    /// One hypothesis a goal for every pedestrian, with the goal's weight; for the variant without
    /// goals, one a noise vector, all equally likely.
    pub(crate) fn forecast_towards(
        &self,
        windows: &[Window],
        sets: Vec<Vec<GoalSet>>,
    ) -> Result<Vec<Forecast>, ForecastError> {
        if !self.config().star.variant.uses_goal() {
            return self.forecast_without_goals(windows);
        }
        let goals: Vec<Vec<Vec<Position>>> = sets
            .iter()
            .map(|sets| sets.iter().map(|set| set.goals().to_vec()).collect())
            .collect();
        let rollouts = self
            .network
            .forecast_windows(windows, &goals, Noise::Expected, Integrator::StableEuler)
            .map_err(|error| ForecastError::model(self.name(), error))?;
        rollouts
            .into_iter()
            .zip(sets)
            .map(|(rollout, sets)| {
                let weights = sets.iter().flat_map(GoalSet::weights).copied().collect();
                let goals = sets.iter().flat_map(GoalSet::goals).copied().collect();
                forecast(rollout, Some(weights), Some(goals))
            })
            .collect()
    }

    /// Plain STAR: noise samples, all equally likely.
    fn forecast_without_goals(&self, windows: &[Window]) -> Result<Vec<Forecast>, ForecastError> {
        let noise = Noise::Draws {
            count: NOISE_HYPOTHESES,
            seed: self.config().training.seed,
        };
        self.network
            .forecast_windows(
                windows,
                &unused_goals(windows),
                noise,
                Integrator::StableEuler,
            )
            .map_err(|error| ForecastError::model(self.name(), error))?
            .into_iter()
            .map(|rollout| forecast(rollout, None, None))
            .collect()
    }
}

impl Forecaster for Ddl {
    fn name(&self) -> String {
        "DDL".into()
    }

    fn forecast(&self, window: &Window) -> Result<Forecast, ForecastError> {
        let mut forecasts = self.forecast_all(std::slice::from_ref(window))?;
        // one window in, one forecast out
        Ok(forecasts.remove(0))
    }

    fn forecast_all(&self, windows: &[Window]) -> Result<Vec<Forecast>, ForecastError> {
        let goals = self.goals.goals(windows)?;
        self.forecast_towards(windows, goals)
    }
}

/// A rollout with its weights (equal when not given) and goals as a forecast.
pub(crate) fn forecast(
    rollout: WindowRollout,
    weights: Option<Vec<f64>>,
    goals: Option<Vec<Position>>,
) -> Result<Forecast, ForecastError> {
    let (pedestrians, hypotheses) = (rollout.pedestrians, rollout.hypotheses);
    let weights =
        weights.unwrap_or_else(|| vec![1.0 / hypotheses as f64; pedestrians * hypotheses]);
    Ok(Forecast::new(
        pedestrians,
        hypotheses,
        rollout.positions,
        weights,
        goals,
    )?)
}

/// A goal for everybody, for the variant that reads none.
pub(crate) fn unused_goals(windows: &[Window]) -> Vec<Vec<Vec<Position>>> {
    windows
        .iter()
        .map(|window| vec![vec![[0.0; 2]]; window.len()])
        .collect()
}

fn load_network(
    config: &RunConfig,
    device: ComputeDevice,
    weights: &Path,
) -> Result<StarNetwork, DdlError> {
    let network = StarNetwork::new(config.star.clone(), config.training.seed, device)?;
    load_parameters(network.parameters(), weights)?;
    Ok(network)
}
