//! Training that starts from another model: its record and its settings.

use crate::run::goal_recipe::GoalRecipe;
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
