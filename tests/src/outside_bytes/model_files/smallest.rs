//! The smallest networks there are: what is fuzzed is the reading.

use ddl::network::{MotionNetwork, ProposalConfig, ProposalNetwork, StarConfig};
use ddl::{BuiltinModel, GoalRecipe, RunConfig};

/// The configuration of a run with the smallest networks, whose goals are proposed.
pub(super) fn config() -> RunConfig {
    let mut config = BuiltinModel::default()
        .config()
        .expect("the built-in models are whole");
    config.star = StarConfig {
        model_width: 2,
        heads: 1,
        feed_forward_width: 1,
        spatial_layers: 1,
        noise_width: 1,
        ..config.star
    };
    config.goals = GoalRecipe::proposed(1);
    if let Some(proposal) = &mut config.goals.proposal {
        proposal.network = ProposalConfig {
            members: 1,
            ends: 2,
            width: 2,
            layers: 1,
            neighbour_width: 1,
            heads: 1,
            neighbours: 1,
            ..ProposalConfig::default()
        };
    }
    config.data.walkers = 2;
    config
}

/// The forecasting network.
pub(super) fn network(config: &RunConfig) -> MotionNetwork {
    MotionNetwork::new(config.star.clone(), 1).expect("a sound configuration")
}

/// The network that proposes goals.
pub(super) fn proposal(config: &RunConfig) -> ProposalNetwork {
    let recipe = config.goals.proposal.clone().expect("goals are proposed");
    ProposalNetwork::new(recipe.network, 1).expect("a sound configuration")
}
