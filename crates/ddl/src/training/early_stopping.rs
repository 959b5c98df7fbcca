//! The validation error of each epoch during training.

use crate::device::Device;
use crate::error::DdlError;
use crate::forecast::shaped::{self, GuidedGoals};
use crate::goals::model::GoalModel;
use crate::run::config::RunConfig;
use crate::run::directory::RunDirectory;
use crate::training::best_epoch::is_over;
use crate::training::starting_weights::StartingWeights;
use crate::windows::test_set::TestSet;
use ddl_core::Window;
use ddl_data::Fold;
use ddl_eval::{ScoredWindow, metric::displacement::DisplacementErrors};
use ddl_network::weights::Weights;
use ddl_network::{EpochReport, ForecastWindows, StepRule};

/// Least number of validation pedestrians that each epoch is measured on, if available.
const PEDESTRIANS: usize = 1000;

/// Validation windows with their goals, and the number of epochs without improvement that ends the training.
#[derive(Debug)]
pub(crate) struct EarlyStopping {
    patience: usize,
    /// What a forecaster sees of the windows: also their bystanders.
    scenes: Vec<Window>,
    windows: Vec<Window>,
    goals: GuidedGoals,
    seed: u64,
    starts_trained: bool,
}

impl EarlyStopping {
    /// The validation windows of the fold, or a seeded part of them; `None` if the run trains all epochs.
    pub(crate) fn of(goals: &GoalModel, fold: &Fold<'_>) -> Result<Option<Self>, DdlError> {
        let config = goals.config();
        let (data, Some(patience)) = (&config.data, config.patience) else {
            return Ok(None);
        };
        let (rule, share) = (data.window_rule, data.validation);
        let windows = TestSet::validation(fold, data.convention, rule, share, Some(PEDESTRIANS)).windows;
        let scenes: Vec<Window> = windows.iter().map(Window::without_future).collect();
        Ok(Some(Self {
            patience,
            goals: GuidedGoals {
                sets: goals.goals(&scenes)?,
                familiarity: scenes.iter().map(|scene| goals.familiarity(scene)).collect(),
            },
            scenes,
            windows,
            seed: config.training.seed,
            starts_trained: config.from.is_some(),
        }))
    }

    /// minADE over the pedestrians in metres, as under the protocol `fair`.
    pub(crate) fn min_ade(&self, network: &dyn ForecastWindows) -> Result<f64, DdlError> {
        let (scenes, goals) = (&self.scenes, self.goals.clone());
        let forecasts = shaped::towards(network, self.seed, scenes, goals, StepRule::Bounded)?;
        let (mut sum, mut pedestrians) = (0.0, 0);
        for (window, forecast) in self.windows.iter().zip(forecasts) {
            let forecast = forecast.without_bystanders(window);
            let errors = DisplacementErrors::of(&ScoredWindow::new(window, &forecast)?);
            sum += (0..window.len()).map(|i| errors.min_ade(i)).sum::<f64>();
            pedestrians += window.len();
        }
        Ok(sum / pedestrians as f64)
    }

    /// The first epoch to measure. Epoch 0, before the first step, counts if training starts from a trained network.
    pub(crate) fn first_epoch(&self) -> usize {
        usize::from(!self.starts_trained)
    }

    /// Whether the last `patience` epochs brought no improvement.
    pub(crate) fn is_over(&self, epochs: &[EpochReport]) -> bool {
        is_over(epochs, self.patience)
    }
}

/// For a training that starts from another model: its own proposal network or the retrained one, whichever gives the
/// untrained forecasting network the smaller error. Without early stopping, the retrained one.
pub(crate) fn better_goals(
    start: StartingWeights,
    trained: Weights,
    run: &RunDirectory,
    config: &RunConfig,
    device: Device,
    fold: &Fold<'_>,
) -> Result<Weights, DdlError> {
    let Some(untrained) = start.proposal else {
        return Ok(trained);
    };
    let Some(recipe) = &config.goals.proposal else {
        return Ok(trained);
    };
    let network = device.forecasting(&config.star, |_| Ok(start.network))?;
    let measured = |weights: &Weights| -> Result<f64, DdlError> {
        let proposal = device.proposing(&recipe.network, |_| Ok(weights.clone()))?;
        let goals = GoalModel::with_network(run.clone(), config.clone(), Some(proposal))?;
        let stopping = EarlyStopping::of(&goals, fold)?;
        stopping.map_or(Ok(0.0), |stopping| stopping.min_ade(&*network))
    };
    let (before, after) = (measured(&untrained)?, measured(&trained)?);
    Ok(if before < after { untrained } else { trained })
}
