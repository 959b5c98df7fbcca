//! How much work a benchmark is: a table.

use anyhow::bail;
use std::str::FromStr;

/// A named amount of work.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Profile {
    pub(crate) name: &'static str,
    /// The first so many folds of a convention.
    pub(crate) folds: usize,
    pub(crate) epochs: u32,
    /// Walkers trained on in each epoch; none is all.
    pub(crate) train_walkers: Option<u32>,
    /// Test walkers scored; none is all.
    pub(crate) test_walkers: Option<u32>,
}

#[rustfmt::skip]
const PROFILES: [Profile; 3] = [
    // Shows that everything works; its numbers mean nothing.
    Profile { name: "smoke", folds: 2, epochs: 1, train_walkers: Some(600), test_walkers: Some(150) },
    // Numbers worth reading, in minutes on two cores.
    Profile { name: "quick", folds: 5, epochs: 4, train_walkers: Some(8000), test_walkers: Some(2500) },
    // The paper's amount of training, on every window.
    Profile { name: "paper", folds: 5, epochs: 200, train_walkers: None, test_walkers: None },
];

impl FromStr for Profile {
    type Err = anyhow::Error;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        match PROFILES.into_iter().find(|profile| profile.name == text) {
            Some(profile) => Ok(profile),
            None => bail!("a profile is smoke, quick or paper"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn profiles_are_found_by_name_and_grow() {
        let [smoke, quick, paper] =
            ["smoke", "quick", "paper"].map(|name| name.parse::<Profile>().unwrap());
        assert!(smoke.epochs < quick.epochs && quick.epochs < paper.epochs);
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
