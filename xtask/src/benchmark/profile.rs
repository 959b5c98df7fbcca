//! How much work a benchmark is: a table.

use std::str::FromStr;

use anyhow::bail;

use super::recipe::{FADING, PUBLISHED, RECOMMENDED, Recipe, RecipeName, SHORT};

/// A named amount of work.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Profile {
    pub(crate) name: &'static str,
    /// The first so many folds of a convention.
    pub(crate) folds: usize,
    /// Batches that the proposal network is trained on; none is the program's default.
    pub(crate) proposal_steps: Option<u32>,
    /// Test walkers scored; none is all.
    pub(crate) test_walkers: Option<u32>,
    recommended: Training,
    published: Training,
}

/// A recipe, and for how long it is followed.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Training {
    pub(crate) recipe: Recipe,
    pub(crate) epochs: u32,
    /// Walkers trained on in each epoch; none is as many as the recipe says.
    pub(crate) walkers: Option<u32>,
}

impl Profile {
    /// How models are trained by the recipe of that name.
    pub(crate) fn training(&self, recipe: RecipeName) -> &Training {
        match recipe {
            RecipeName::Recommended => &self.recommended,
            RecipeName::Published => &self.published,
        }
    }
}

const fn training(recipe: Recipe, epochs: u32, walkers: Option<u32>) -> Training {
    Training {
        recipe,
        epochs,
        walkers,
    }
}

#[rustfmt::skip]
const PROFILES: [Profile; 4] = [
    // Shows that everything works; its numbers mean nothing.
    Profile {
        name: "smoke", folds: 2, proposal_steps: Some(40), test_walkers: Some(150),
        recommended: training(RECOMMENDED, 1, Some(600)),
        published: training(PUBLISHED, 1, Some(600)),
    },
    // Numbers worth reading, in minutes on two cores.
    Profile {
        name: "quick", folds: 5, proposal_steps: None, test_walkers: Some(2500),
        recommended: training(RECOMMENDED, 10, None),
        published: training(SHORT, 10, Some(4000)),
    },
    // Every window, trained until little more is learned: by the published recipe an evening on two cores. The recommended one
    // has reached its end by then.
    Profile {
        name: "evening", folds: 5, proposal_steps: None, test_walkers: None,
        recommended: training(RECOMMENDED, 20, None),
        published: training(FADING, 60, None),
    },
    // As much training as the recipe says, on every window.
    Profile {
        name: "paper", folds: 5, proposal_steps: None, test_walkers: None,
        recommended: training(RECOMMENDED, 20, None),
        published: training(PUBLISHED, 200, None),
    },
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
        let profiles = ["smoke", "quick", "evening", "paper"];
        let profiles = profiles.map(|name| name.parse::<Profile>().unwrap());
        for recipe in [RecipeName::Recommended, RecipeName::Published] {
            let trainings = profiles.each_ref().map(|profile| profile.training(recipe));
            assert!(trainings.iter().all(|one| one.recipe.name == recipe));
            assert!(trainings.is_sorted_by_key(|one| one.epochs));
            let [smoke, quick, evening, paper] = trainings;
            assert!(smoke.epochs < quick.epochs && quick.epochs < evening.epochs);
            assert!(smoke.walkers.is_some());
            assert!(evening.walkers.is_none() && paper.walkers.is_none());
        }
        let [smoke, quick, evening, paper] = profiles;
        assert!(smoke.test_walkers < quick.test_walkers);
        assert_eq!((evening.test_walkers, paper.test_walkers), (None, None));
        assert_eq!(paper.published.epochs, 200);
        let message = "fast".parse::<Profile>().unwrap_err().to_string();
        assert!(message.contains("quick"), "{message}");
    }
}
