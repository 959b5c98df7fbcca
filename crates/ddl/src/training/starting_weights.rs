//! The weights of another model that a training starts from.

use crate::error::DdlError;
use crate::model::ddl::Ddl;
use crate::run::config::leaves;
use crate::run::goal_recipe::GoalRecipe;
use crate::run::model_source::ModelSource;
use crate::run::starting_model::InitialModel;
use crate::trust::fingerprints::TrackFingerprints;
use ddl_core::Setting;
use ddl_network::weights::{Weights, in_hex};
use ddl_network::{DeviceChoice, StarConfig};
use sha2::{Digest as _, Sha256};

#[derive(Debug)]
pub(crate) struct StartingWeights {
    pub(crate) network: Weights,
    /// `None` if all goals are retrieved.
    pub(crate) proposal: Option<Weights>,
    pub(crate) record: InitialModel,
    pub(crate) fingerprints: TrackFingerprints,
}

impl StartingWeights {
    pub(crate) fn of(
        source: &ModelSource,
        star: &StarConfig,
        goals: &GoalRecipe,
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
            "cannot be trained further here: its {difference} as requested; leave out the options that require another \
             network, or train from random weights ({})",
                Setting::From.to("none")
            )));
        }
        let (network, proposal) = model.weights()?;
        let proposal = proposal.filter(|_| wanted);
        let mut hasher = Sha256::new();
        hash(&network, &mut hasher);
        if let Some(proposal) = &proposal {
            hash(proposal, &mut hasher);
        }
        let record = InitialModel { model: source.to_string(), sha256: in_hex(hasher) };
        Ok(Self { network, proposal, record, fingerprints: model.goal_model().fingerprints().clone() })
    }
}

fn hash(weights: &Weights, hasher: &mut Sha256) {
    for weight in weights.numbers() {
        hasher.update(weight.to_le_bytes());
    }
}
