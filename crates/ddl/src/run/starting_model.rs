//! Training that starts from another model: its record and its settings.

use crate::error::DdlError;
use crate::run::builtin_model::BuiltinModel;
use crate::run::goal_recipe::GoalRecipe;
use crate::run::training_data::fold_by_name;
use crate::run::validation_part::ValidationPart;
use ddl_core::Window;
use ddl_data::{Convention, Dataset};
use ddl_network::{TrainingConfig, Variant};
use serde::{Deserialize, Serialize};

/// The weights that a run started with, as its `config.json` records them.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct InitialModel {
    /// The model as given by the user.
    pub model: String,
    /// SHA-256 of the weights of both networks.
    pub sha256: String,
}

/// Number of pedestrian-windows below which training on own recordings starts from a built-in model.
const FEW: usize = 10_000;

/// The model that training on own recordings starts from, with the number of pedestrian-windows of the training, if
/// there are few of them; `None` for random weights.
///
/// # Errors
/// The fold or a recording of the validation part is not known.
pub fn starting_model(
    dataset: &Dataset,
    fold: &str,
    part: &ValidationPart,
) -> Result<Option<(BuiltinModel, usize)>, DdlError> {
    if dataset.convention() != Convention::Own {
        return Ok(None);
    }
    let fold = fold_by_name(dataset, fold)?.with_validation_recordings(&part.recordings)?;
    let rule = dataset.convention().headline_rule();
    let windows = fold.training_split(rule, part.share.clamp(0.0, 1.0)).training;
    let pedestrians: usize = windows.iter().map(Window::len).sum();
    Ok((pedestrians > 0 && pedestrians < FEW).then(|| (BuiltinModel::default(), pedestrians)))
}

/// The training of a trained model's forecasting network on few more recordings: fewer steps with a smaller step size.
#[must_use]
pub fn fine_tuning_config(variant: Variant) -> TrainingConfig {
    TrainingConfig { epochs: 5, learning_rate: 1e-4, ..TrainingConfig::recommended(variant) }
}

/// The training of a trained model's proposal network on few more recordings: fewer steps with a smaller step size.
/// Only the nearest endpoint of each pedestrian is trained, because the endpoints are already spread.
#[must_use]
pub fn fine_tuning_goal_recipe(seed: u64) -> GoalRecipe {
    let mut recipe = GoalRecipe::proposed(seed);
    if let Some(proposal) = &mut recipe.proposal {
        proposal.training.steps = 300;
        proposal.training.learning_rate = 3e-4;
        proposal.training.relaxed_ends = 1.0;
        proposal.training.memory.steps = 600;
    }
    recipe
}
