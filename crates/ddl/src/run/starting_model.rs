use crate::goals::recipe::GoalRecipe;
use ddl_network::{TrainingConfig, Variant};
use serde::{Deserialize, Serialize};

/// Which weights a run began with, as its `config.json` records it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StartingModel {
    /// The model, as it was named.
    pub model: String,
    /// SHA-256 of the weights of both networks.
    pub sha256: String,
}

/// How the forecasting network of a trained model is trained further, on few recordings: smaller steps, fewer of them.
#[must_use]
pub fn training_further(variant: Variant) -> TrainingConfig {
    TrainingConfig {
        epochs: 5,
        learning_rate: 1e-4,
        ..TrainingConfig::recommended(variant)
    }
}

/// How the proposal network of a trained model is trained further: smaller steps, fewer of them, and each from the nearest end alone, because
/// the ends have parted already.
#[must_use]
pub fn goals_trained_further(seed: u64) -> GoalRecipe {
    let mut recipe = GoalRecipe::proposed(seed);
    if let Some(proposal) = &mut recipe.proposal {
        proposal.training.steps = 300;
        proposal.training.learning_rate = 3e-4;
        proposal.training.relaxed_ends = 1.0;
        proposal.training.memory.steps = 600;
    }
    recipe
}
