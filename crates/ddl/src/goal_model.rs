//! Where the goals of a run come from: its expert library and, where it has one, its proposal network.

use crate::run_config::RunConfig;
use crate::run_directory::RunDirectory;
use crate::{DdlError, GoalRecipe, experts, goals, views};
use ddl_data::{Position, WINDOW, Window};
use ddl_eval::ForecastError;
use ddl_goal::{ExpertLibrary, GoalEstimator, GoalEstimatorParams, GoalSet, QuerySpan};
use ddl_star::{ComputeDevice, DeviceChoice, ProposalNetwork, load_parameters};
use rayon::prelude::*;
use std::path::Path;

/// Estimates where the walkers of a window are going, from the 8 observed frames and nothing else.
#[derive(Debug)]
pub struct GoalModel {
    run: RunDirectory,
    config: RunConfig,
    estimator: GoalEstimator,
    /// The network, and the share of the probability that the retrieved goals have beside it.
    proposer: Option<(ProposalNetwork, f64)>,
}

impl GoalModel {
    /// Loads the goals' part of the run at `path`, whose forecasting network need not be trained yet.
    ///
    /// # Errors
    /// When there is no run, its goals are not trained, one of the files is broken, or the device
    /// cannot be had.
    pub fn load(path: &Path, device: DeviceChoice) -> Result<Self, DdlError> {
        let run = RunDirectory::new(path);
        let config = run.config()?;
        if !run.has_goals(&config.goals) {
            let problem = "has no goals yet; run the same `ddl train` command again to go on";
            return Err(DdlError::run(path, problem));
        }
        Self::of_run(run, config, ComputeDevice::open(device)?)
    }

    pub(crate) fn of_run(
        run: RunDirectory,
        config: RunConfig,
        device: ComputeDevice,
    ) -> Result<Self, DdlError> {
        let library = experts::load(&config.goals_origin(), config.data.walkers, &run.experts())?;
        let params = config.goals.retrieval.clone().query(QuerySpan::Observed);
        let estimator = GoalEstimator::new(params.check()?, library)?;
        let proposer = match &config.goals.proposal {
            None => None,
            Some(recipe) => {
                let network =
                    ProposalNetwork::new(recipe.network.clone(), recipe.training.seed, device)?;
                load_parameters(
                    network.parameters(),
                    &config.goals_origin(),
                    &run.proposal(),
                )?;
                Some((network, recipe.retrieved_share))
            }
        };
        Ok(Self {
            run,
            config,
            estimator,
            proposer,
        })
    }

    /// What decided the run.
    pub fn config(&self) -> &RunConfig {
        &self.config
    }

    /// Where the run lies.
    pub fn run(&self) -> &RunDirectory {
        &self.run
    }

    /// How the goals are made.
    pub fn recipe(&self) -> &GoalRecipe {
        &self.config.goals
    }

    /// The retrieval of similar walkers, which sees the observed positions alone.
    pub fn estimator(&self) -> &GoalEstimator {
        &self.estimator
    }

    /// Numbers learned by the proposal network; 0 without one.
    pub fn parameter_count(&self) -> usize {
        self.proposer
            .as_ref()
            .map_or(0, |(network, _)| network.parameters().count())
    }

    /// The goals of every pedestrian of every window, from the observed frames alone.
    ///
    /// The network computes in single precision, many walkers at a time: a walker's goals may differ from those it has in
    /// other company by rounding, and near a tie between two choices of goals by more.
    ///
    /// # Errors
    /// When positions are so far apart that distances leave the range of `f64`, or libtorch fails.
    pub fn goals(&self, windows: &[Window]) -> Result<Vec<Vec<GoalSet>>, ForecastError> {
        match &self.proposer {
            None => goals::retrieved(&self.estimator, windows),
            Some((network, share)) => self.proposed(network, *share, windows),
        }
    }

    /// Goals that stand for the network's ends and the retrieved goals together.
    fn proposed(
        &self,
        network: &ProposalNetwork,
        retrieved_share: f64,
        windows: &[Window],
    ) -> Result<Vec<Vec<GoalSet>>, ForecastError> {
        let clusters = self.estimator.params().clusters();
        let mut seen = Vec::new();
        for window in windows {
            let walkers = views::of_window(window, network.config().neighbours).map_err(failed)?;
            seen.extend(walkers);
        }
        let (frames, views): (Vec<_>, Vec<_>) =
            seen.into_iter().map(|seen| (seen.frame, seen.view)).unzip();
        let proposed = network.propose(&views).map_err(failed)?;
        let retrieved = goals::retrieved(&self.estimator, windows)?;
        let retrieved: Vec<GoalSet> = retrieved.into_iter().flatten().collect();
        let sets: Vec<GoalSet> = (frames, proposed, retrieved)
            .into_par_iter()
            .map(|(frame, proposed, retrieved)| {
                let (mut ends, mut weights) = (proposed.ends, proposed.weights);
                for weight in &mut weights {
                    *weight *= 1.0 - retrieved_share;
                }
                ends.extend(retrieved.goals().iter().map(|&goal| frame.to_frame(goal)));
                weights.extend(retrieved.weights().iter().map(|w| w * retrieved_share));
                GoalSet::of_ends(&frame, &ends, &weights, clusters)
            })
            .collect::<Result<_, _>>()
            .map_err(failed)?;
        let mut sets = sets.into_iter();
        Ok(windows
            .iter()
            .map(|window| sets.by_ref().take(window.len()).collect())
            .collect())
    }

    /// Where walkers whose future is known are led in training: to the proposed goal nearest the true end, or to the true
    /// end where nothing is proposed. What is retrieved is left out: the library holds the very walkers that are learned from.
    ///
    /// # Errors
    /// When libtorch fails.
    pub(crate) fn lessons(&self, windows: &[Window]) -> Result<Vec<Vec<Position>>, ForecastError> {
        let end = |window: &Window, i: usize| window.track(i)[WINDOW - 1];
        let Some((network, _)) = &self.proposer else {
            return Ok(windows
                .iter()
                .map(|window| (0..window.len()).map(|i| end(window, i)).collect())
                .collect());
        };
        let clusters = self.estimator.params().clusters();
        windows
            .iter()
            .map(|window| {
                let seen = views::of_window(window, network.config().neighbours).map_err(failed)?;
                let (frames, views): (Vec<_>, Vec<_>) =
                    seen.into_iter().map(|seen| (seen.frame, seen.view)).unzip();
                let proposed = network.propose(&views).map_err(failed)?;
                frames
                    .par_iter()
                    .zip(proposed)
                    .enumerate()
                    .map(|(i, (frame, ends))| {
                        let set = GoalSet::of_ends(frame, &ends.ends, &ends.weights, clusters)
                            .map_err(failed)?;
                        let [x, y] = end(window, i);
                        let off = |g: &Position| (g[0] - x).hypot(g[1] - y);
                        let nearest = set.goals().iter().min_by(|a, b| off(a).total_cmp(&off(b)));
                        Ok(nearest.copied().unwrap_or([x, y]))
                    })
                    .collect()
            })
            .collect()
    }

    /// The published estimator: under the protocol `published` its query reads the first future frame.
    pub(crate) fn published_estimator(&self, query: QuerySpan) -> Result<GoalEstimator, DdlError> {
        let library: ExpertLibrary = self.estimator.library().clone();
        let retrieval = self.recipe().retrieval.clone();
        let params: GoalEstimatorParams = retrieval.into_published().query(query);
        Ok(GoalEstimator::new(params.check()?, library)?)
    }
}

fn failed(error: impl std::error::Error + Send + Sync + 'static) -> ForecastError {
    ForecastError::model("goals", error)
}
