//! The model whose weights a training begins with, in place of random ones.

use crate::run_config::leaves;
use crate::{Ddl, DdlError, GoalRecipe, ModelSource, sha256};
use ddl_star::{
    DeviceChoice, Parameters, ProposalNetwork, StarConfig, StarNetwork, TrainingConfig, Variant,
};
use serde::{Deserialize, Serialize};
use sha2::{Digest as _, Sha256};

/// Which weights a run began with, as its `config.json` records it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StartingModel {
    /// The model, as it was named.
    pub model: String,
    /// SHA-256 of the weights of both networks.
    pub sha256: String,
}

/// Both networks of that model.
#[derive(Debug)]
pub(crate) struct StartingWeights {
    pub(crate) network: StarNetwork,
    /// None where goals are retrieved alone.
    pub(crate) proposal: Option<ProposalNetwork>,
    pub(crate) record: StartingModel,
}

impl StartingWeights {
    /// The weights of a model, for networks of these sizes.
    ///
    /// # Errors
    /// When the model cannot be loaded, or its networks are of other sizes than those to be trained.
    pub(crate) fn of(
        source: &ModelSource,
        (star, goals): (&StarConfig, &GoalRecipe),
        device: DeviceChoice,
    ) -> Result<Self, DdlError> {
        let model = Ddl::open(source, device)?;
        let config = model.config();
        let wanted = goals.proposal.is_some();
        let of_proposal = |recipe: &GoalRecipe| {
            let proposal = recipe.proposal.as_ref().filter(|_| wanted);
            leaves("goals.proposal.network", &proposal.map(|p| &p.network))
        };
        let of_network = leaves("star", &config.star).difference(&leaves("star", star));
        let of_goals = || of_proposal(&config.goals).difference(&of_proposal(goals));
        if let Some(difference) = of_network.or_else(of_goals) {
            return Err(source.wrong(format!(
                "cannot be trained further here: its {difference} as asked for; leave out the options that ask for another network, or train from \
                 random weights (--from none)"
            )));
        }
        let (network, proposal) = model.into_networks();
        let proposal = proposal.filter(|_| wanted);
        let mut hasher = Sha256::new();
        hash(network.parameters(), &mut hasher)?;
        if let Some(proposal) = &proposal {
            hash(proposal.parameters(), &mut hasher)?;
        }
        let record = StartingModel {
            model: source.to_string(),
            sha256: sha256::in_hex(hasher),
        };
        Ok(Self {
            network,
            proposal,
            record,
        })
    }
}

fn hash(parameters: &Parameters, hasher: &mut Sha256) -> Result<(), DdlError> {
    for weight in parameters.to_vec()? {
        hasher.update(weight.to_le_bytes());
    }
    Ok(())
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
    }
    recipe
}
