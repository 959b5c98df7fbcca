//! The settings of the goals of a run.

use crate::error::DdlError;
use ddl_goal::{GoalEstimatorParams, QuerySpan};
use ddl_network::{ProposalConfig, ProposalTraining};
use serde::{Deserialize, Serialize};

/// How goals are made: retrieved from the expert library, or proposed by a network and pooled with retrieved ones.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GoalRecipe {
    /// Retrieval of similar pedestrians; it also sets the number of goals.
    pub retrieval: GoalEstimatorParams,
    /// The proposal network, whose endpoints are pooled with the retrieved goals; `None`: all goals are retrieved.
    pub proposal: Option<ProposalRecipe>,
}

/// A proposal network and how it is trained.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ProposalRecipe {
    /// The shape of the network.
    pub network: ProposalConfig,
    /// The training of the network.
    pub training: ProposalTraining,
    /// Probability of the retrieved goals. They are pooled with the endpoints of the network before K goals are chosen
    /// to represent both.
    pub retrieved_share: f64,
    /// Probability of each of four endpoints that join those of the network: stopping at once, turning to either side
    /// and turning back. They cover what the training places lack.
    #[serde(default, skip_serializing_if = "is_none")]
    pub unforeseen_share: f64,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde passes a reference")]
fn is_none(share: &f64) -> bool {
    *share <= 0.0
}

impl Default for ProposalRecipe {
    /// Chosen on validation splits of training recordings (`docs/tried.md`).
    fn default() -> Self {
        Self {
            network: ProposalConfig::default(),
            training: ProposalTraining::default(),
            retrieved_share: 0.15,
            unforeseen_share: 0.0,
        }
    }
}

impl ProposalRecipe {
    fn words(&self) -> String {
        let Self { network, training, .. } = self;
        let (members, steps) = (network.members, training.steps);
        let memory = match network.memory {
            Some(_) => format!(" and {} more for the memory branch", training.memory.steps),
            None => String::new(),
        };
        format!("proposed by {members} networks trained {steps} steps{memory}")
    }
}

impl GoalRecipe {
    /// Goals proposed by a network: the default.
    #[must_use]
    pub fn proposed(seed: u64) -> Self {
        let mut proposal = ProposalRecipe::default();
        proposal.training.seed = seed;
        Self { proposal: Some(proposal), ..Self::retrieved(seed) }
    }

    /// Goals retrieved from the expert library.
    #[must_use]
    pub fn retrieved(seed: u64) -> Self {
        Self { retrieval: GoalEstimatorParams { seed, ..Default::default() }, proposal: None }
    }

    /// Checks every parameter.
    ///
    /// # Errors
    /// The first parameter that is out of range, or a query that reads the future.
    pub fn check(&self) -> Result<(), DdlError> {
        self.retrieval.check()?;
        if self.retrieval.query != QuerySpan::Observed {
            return Err(DdlError::GoalQuery);
        }
        if let Some(proposal) = &self.proposal {
            proposal.network.check()?;
            proposal.training.check()?;
            for (field, share) in
                [("retrieved_share", proposal.retrieved_share), ("unforeseen_share", proposal.unforeseen_share)]
            {
                if !(0.0..=1.0).contains(&share) {
                    return Err(DdlError::GoalShare { field, share });
                }
            }
        }
        Ok(())
    }

    /// Text that names the origin of the goals without the expert library.
    #[must_use]
    pub(crate) fn description_without_library(&self) -> String {
        match &self.proposal {
            None => "none: goals are retrieved from the expert library, which is missing".to_owned(),
            Some(proposal) => format!("{}, no expert library", proposal.words()),
        }
    }

    /// Text that names the origin of the goals.
    pub(crate) fn words(&self) -> String {
        match &self.proposal {
            None => "retrieved".to_owned(),
            Some(proposal) => format!("{}, and retrieved (share {})", proposal.words(), proposal.retrieved_share),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn goals_of_forecasts_read_no_future() {
        let mut recipe = GoalRecipe::retrieved(1);
        assert!(recipe.check().is_ok());
        recipe.retrieval = GoalEstimatorParams::published();
        assert!(matches!(recipe.check(), Err(DdlError::GoalQuery)));
    }
}
