use crate::error::DdlError;
use ddl_goal::GoalEstimatorParams;
use ddl_network::{ProposalConfig, ProposalTraining};
use serde::{Deserialize, Serialize};

/// How goals are made: retrieved from the expert library, or proposed by a network and pooled with retrieved ones.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GoalRecipe {
    /// Retrieval of similar pedestrians; also says how many goals there are.
    pub retrieval: GoalEstimatorParams,
    /// The proposal network whose ends are pooled with the retrieved goals; without one these are all.
    pub proposal: Option<ProposalRecipe>,
}

/// A proposal network and how it is trained.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ProposalRecipe {
    /// Its shape.
    pub network: ProposalConfig,
    /// Its training.
    pub training: ProposalTraining,
    /// Share of the probability given to the retrieved goals, which are pooled with the network's ends before K goals are
    /// chosen to stand for both.
    pub retrieved_share: f64,
}

impl Default for ProposalRecipe {
    /// Chosen on validation splits of training recordings (`docs/tried.md`).
    fn default() -> Self {
        Self {
            network: ProposalConfig::default(),
            training: ProposalTraining::default(),
            retrieved_share: 0.15,
        }
    }
}

impl ProposalRecipe {
    fn words(&self) -> String {
        let Self {
            network, training, ..
        } = self;
        let (members, steps) = (network.members, training.steps);
        let memory = match network.memory {
            Some(_) => format!(" and {} more for what is remembered", training.memory.steps),
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
        Self {
            proposal: Some(proposal),
            ..Self::retrieved(seed)
        }
    }

    /// Goals retrieved from the expert library.
    #[must_use]
    pub fn retrieved(seed: u64) -> Self {
        Self {
            retrieval: GoalEstimatorParams::default().seed(seed),
            proposal: None,
        }
    }

    /// Checks every parameter.
    ///
    /// # Errors
    /// Naming the first that is out of range.
    pub fn check(&self) -> Result<(), DdlError> {
        self.retrieval.clone().check()?;
        if let Some(proposal) = &self.proposal {
            proposal.network.check()?;
            proposal.training.check()?;
            if !(0.0..=1.0).contains(&proposal.retrieved_share) {
                return Err(DdlError::RetrievedShare(proposal.retrieved_share));
            }
        }
        Ok(())
    }

    /// Where the goals come from when the expert library is not at hand, in words.
    #[must_use]
    pub fn words_without_library(&self) -> String {
        match &self.proposal {
            None => "none: they would be retrieved, and there is no expert library".to_owned(),
            Some(proposal) => format!("{}, no expert library", proposal.words()),
        }
    }

    /// Where the goals come from, in words.
    #[must_use]
    pub fn words(&self) -> String {
        match &self.proposal {
            None => "retrieved".to_owned(),
            Some(proposal) => format!(
                "{}, and retrieved (share {})",
                proposal.words(),
                proposal.retrieved_share
            ),
        }
    }
}
