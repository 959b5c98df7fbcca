//! The smallest possible networks, because only the reading is fuzzed.

use ddl::network::{MemoryConfig, MotionNetwork, ProposalConfig, ProposalNetwork, StarConfig};
use ddl::{RunConfig, Variant};

use crate::drawn_model;

/// The configuration of a run with the smallest networks, whose goals are proposed.
pub(super) fn config() -> RunConfig {
    let mut config = drawn_model::config(Variant::Full);
    config.star = StarConfig {
        model_width: 2,
        heads: 1,
        feed_forward_width: 1,
        spatial_layers: 1,
        noise_width: 1,
        ..config.star
    };
    if let Some(proposal) = &mut config.goals.proposal {
        proposal.network = ProposalConfig {
            members: 1,
            ends: 2,
            width: 2,
            layers: 1,
            neighbour_width: 1,
            heads: 1,
            neighbours: 1,
            memory: Some(MemoryConfig {
                remembered: 1,
                width: 1,
                heads: 1,
                hidden: 1,
                layers: 1,
                ..MemoryConfig::default()
            }),
            ..ProposalConfig::default()
        };
    }
    config.data.pedestrians = 2;
    config
}

pub(super) fn network(config: &RunConfig) -> MotionNetwork {
    MotionNetwork::new(config.star.clone(), 1).expect("a valid configuration")
}

pub(super) fn proposal(config: &RunConfig) -> ProposalNetwork {
    let recipe = config.goals.proposal.clone().expect("goals are proposed");
    ProposalNetwork::new(recipe.network, 1).expect("a valid configuration")
}
