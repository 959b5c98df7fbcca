//! What a task is likely to take, so that the longest starts first and the time left is known.
//!
//! Only proportions matter. They are those of the full-size network on two cores.

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

/// Seconds a walker takes in one epoch.
const TRAIN: f64 = 0.007;

/// Seconds a walker takes to be scored under all protocols.
const EVALUATE: f64 = 0.03;

/// Expected seconds of training and of scoring.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Cost {
    pub(super) train: f64,
    pub(super) evaluate: f64,
}

impl Cost {
    pub(super) fn of(
        fold: &str,
        epochs: u32,
        train_walkers: Option<u32>,
        test_walkers: Option<u32>,
    ) -> Self {
        let known = TEST_WALKERS.iter().find(|(name, _)| *name == fold);
        let test = known.map_or(TYPICAL_TEST_WALKERS, |(_, walkers)| *walkers);
        let train = ALL_WALKERS - test;
        let capped = |all: f64, cap: Option<u32>| cap.map_or(all, |cap| all.min(f64::from(cap)));
        Self {
            train: f64::from(epochs) * capped(train, train_walkers) * TRAIN,
            evaluate: capped(test, test_walkers) * EVALUATE,
        }
    }

    #[cfg(test)]
    fn total(self) -> f64 {
        self.train + self.evaluate
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scoring_everything_is_longest_on_the_crowded_scene() {
        let cost = |fold| Cost::of(fold, 1, Some(100), None).total();
        assert!(cost("univ") > cost("zara2") && cost("zara2") > cost("hotel"));
        assert!(cost("somewhere else") > 0.0);
    }

    #[test]
    fn a_cap_above_what_there_is_changes_nothing() {
        assert_eq!(
            Cost::of("eth", 2, Some(1_000_000), None),
            Cost::of("eth", 2, None, None)
        );
        let capped = Cost::of("eth", 2, Some(10), Some(10));
        assert!(capped.total() < Cost::of("eth", 2, None, None).total());
    }
}
