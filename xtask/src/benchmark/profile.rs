//! How much work a benchmark is: a table.

use std::borrow::Cow;
use std::str::FromStr;

use anyhow::bail;
use serde::{Deserialize, Serialize};

/// A named amount of work.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Profile {
    pub(crate) name: &'static str,
    /// The first so many folds of a convention.
    pub(crate) folds: usize,
    pub(crate) epochs: u32,
    /// Walkers trained on in each epoch; none is all.
    pub(crate) train_walkers: Option<u32>,
    /// Batches that the proposal network is trained on; none is the program's default.
    pub(crate) proposal_steps: Option<u32>,
    /// Test walkers scored; none is all.
    pub(crate) test_walkers: Option<u32>,
    pub(crate) recipe: Recipe,
}

/// How the optimiser goes about it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Recipe {
    /// Walkers a batch.
    pub(crate) batch_walkers: u32,
    /// Largest step size of Adam.
    pub(crate) learning_rate: f64,
    /// constant or cosine.
    pub(crate) schedule: Cow<'static, str>,
}

/// The paper's.
pub(crate) const PUBLISHED: Recipe = Recipe {
    batch_walkers: 256,
    learning_rate: 1.5e-3,
    schedule: Cow::Borrowed("constant"),
};

/// Small batches, and steps that fade out: what learns most in a few thousand steps. Chosen on
/// validation splits of training recordings (docs/method.md, "The short recipe").
const SHORT: Recipe = Recipe {
    batch_walkers: 16,
    learning_rate: 1e-3,
    schedule: Cow::Borrowed("cosine"),
};

/// The paper's batches, and steps that fade out, so that fewer epochs do.
const FADING: Recipe = Recipe {
    schedule: Cow::Borrowed("cosine"),
    ..PUBLISHED
};

#[rustfmt::skip]
const PROFILES: [Profile; 4] = [
    // Shows that everything works; its numbers mean nothing.
    Profile { name: "smoke", folds: 2, epochs: 1, train_walkers: Some(600), proposal_steps: Some(40), test_walkers: Some(150), recipe: PUBLISHED },
    // Numbers worth reading, in minutes on two cores.
    Profile { name: "quick", folds: 5, epochs: 10, train_walkers: Some(4000), proposal_steps: None, test_walkers: Some(2500), recipe: SHORT },
    // Every window, trained until little more is learned: an evening on two cores.
    Profile { name: "evening", folds: 5, epochs: 60, train_walkers: None, proposal_steps: None, test_walkers: None, recipe: FADING },
    // The paper's amount of training, on every window.
    Profile { name: "paper", folds: 5, epochs: 200, train_walkers: None, proposal_steps: None, test_walkers: None, recipe: PUBLISHED },
];

impl FromStr for Profile {
    type Err = anyhow::Error;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        match PROFILES.into_iter().find(|profile| profile.name == text) {
            Some(profile) => Ok(profile),
            None => bail!("a profile is smoke, quick, evening or paper"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn profiles_are_found_by_name_and_grow() {
        let [smoke, quick, evening, paper] =
            ["smoke", "quick", "evening", "paper"].map(|name| name.parse::<Profile>().unwrap());
        assert!(smoke.epochs < quick.epochs && quick.epochs < evening.epochs);
        assert!(evening.epochs < paper.epochs && evening.train_walkers.is_none());
        assert!(smoke.test_walkers < quick.test_walkers);
        assert_eq!(
            (paper.epochs, paper.train_walkers, paper.test_walkers),
            (200, None, None)
        );
        assert!(
            "fast"
                .parse::<Profile>()
                .unwrap_err()
                .to_string()
                .contains("quick")
        );
    }
}
