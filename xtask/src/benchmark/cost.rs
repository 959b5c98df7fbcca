//! What a task is likely to take, so that the longest starts first and the time left is known.
//!
//! Only proportions matter. They are those of two cores.

use super::recipe::RecipeName;

/// Walkers of the `star` test windows under the published rule, per fold.
const TEST_WALKERS: [(&str, f64); 5] = [
    ("eth", 2_511.0),
    ("hotel", 1_026.0),
    ("univ", 24_254.0),
    ("zara1", 2_324.0),
    ("zara2", 5_900.0),
];

/// A fold this table does not know.
const TYPICAL_TEST_WALKERS: f64 = 5_000.0;

/// Walkers of all recordings together, of which a fold trains on what it does not test on.
const ALL_WALKERS: f64 = 39_398.0;

/// Walkers an epoch of the recommended recipe where nobody says how many.
const RECOMMENDED_WALKERS: u32 = 5_000;

/// Seconds a walker takes in one epoch, the training of the goals spread over all of them, and to be scored: by the full-size
/// network under all protocols, and by the narrow one of the recommended recipe under those without the truth.
const fn seconds(recipe: RecipeName) -> (f64, f64) {
    match recipe {
        RecipeName::Published => (0.007, 0.03),
        RecipeName::Recommended => (0.000_7, 0.02),
    }
}

/// Expected seconds of training and of scoring.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Cost {
    pub(super) train: f64,
    pub(super) evaluate: f64,
}

impl Cost {
    pub(super) fn of(
        fold: &str,
        recipe: RecipeName,
        epochs: u32,
        train_walkers: Option<u32>,
        test_walkers: Option<u32>,
    ) -> Self {
        let known = TEST_WALKERS.iter().find(|(name, _)| *name == fold);
        let test = known.map_or(TYPICAL_TEST_WALKERS, |(_, walkers)| *walkers);
        let train = ALL_WALKERS - test;
        let capped = |all: f64, cap: Option<u32>| cap.map_or(all, |cap| all.min(f64::from(cap)));
        let train_walkers = train_walkers.or(match recipe {
            RecipeName::Published => None,
            RecipeName::Recommended => Some(RECOMMENDED_WALKERS),
        });
        let (train_seconds, evaluate_seconds) = seconds(recipe);
        Self {
            train: f64::from(epochs) * capped(train, train_walkers) * train_seconds,
            evaluate: capped(test, test_walkers) * evaluate_seconds,
        }
    }

    #[cfg(test)]
    fn total(self) -> f64 {
        self.train + self.evaluate
    }
}

#[cfg(test)]
mod tests {
    use super::RecipeName::{Published, Recommended};
    use super::*;

    #[test]
    fn scoring_everything_is_longest_on_the_crowded_scene() {
        let cost = |fold| Cost::of(fold, Published, 1, Some(100), None).total();
        assert!(cost("univ") > cost("zara2") && cost("zara2") > cost("hotel"));
        assert!(cost("somewhere else") > 0.0);
        let whole = |fold| Cost::of(fold, Recommended, 20, None, None).total();
        assert!(whole("univ") > whole("zara2") && whole("zara2") > whole("hotel"));
    }

    #[test]
    fn a_cap_above_what_there_is_changes_nothing() {
        assert_eq!(
            Cost::of("eth", Published, 2, Some(1_000_000), None),
            Cost::of("eth", Published, 2, None, None)
        );
        let capped = Cost::of("eth", Published, 2, Some(10), Some(10));
        assert!(capped.total() < Cost::of("eth", Published, 2, None, None).total());
    }

    #[test]
    fn the_recommended_recipe_takes_the_same_walkers_in_every_fold_unless_told() {
        let cost = |fold, walkers| Cost::of(fold, Recommended, 20, walkers, Some(1000));
        assert_eq!(cost("eth", None), cost("univ", Some(RECOMMENDED_WALKERS)));
        assert!(cost("eth", Some(10_000)).total() > cost("eth", None).total());
    }
}
