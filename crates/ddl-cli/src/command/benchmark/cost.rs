//! Expected time of a task on two cores, so that the longest starts first; only proportions matter.

use super::super::recipe::Recipe;

/// Pedestrians of the `star` test windows under the published rule, per fold.
const TEST_PEDESTRIANS: [(&str, usize); 5] = [
    ("eth", 2_511),
    ("hotel", 1_026),
    ("univ", 24_254),
    ("zara1", 2_324),
    ("zara2", 5_900),
];

const TYPICAL_TEST_PEDESTRIANS: usize = 5_000;

/// Pedestrians of all recordings together; a fold trains on those that it does not test on.
const ALL_PEDESTRIANS: usize = 39_398;

const RECOMMENDED_PEDESTRIANS: usize = 5_000;

/// Expected seconds of training (epochs, pedestrians of each) and of scoring; `None` stands for all pedestrians.
pub(super) fn expected(
    fold: &str,
    recipe: Recipe,
    epochs: usize,
    train_pedestrians: Option<usize>,
    test_pedestrians: Option<usize>,
) -> (f64, f64) {
    let known = TEST_PEDESTRIANS.iter().find(|(name, _)| *name == fold);
    let test = known.map_or(TYPICAL_TEST_PEDESTRIANS, |(_, pedestrians)| *pedestrians);
    let train = ALL_PEDESTRIANS - test;
    // Seconds per pedestrian and epoch (with its share of the training of the goals), and per scored pedestrian. The
    // full-size network is scored under all protocols, the narrow recommended one under the protocols that do not show
    // the future.
    let (train_seconds, evaluate_seconds, usual) = match recipe {
        Recipe::Published => (0.007, 0.03, train),
        Recipe::Recommended => (0.000_7, 0.02, RECOMMENDED_PEDESTRIANS),
    };
    let trained = train.min(train_pedestrians.unwrap_or(usual));
    let scored = test.min(test_pedestrians.unwrap_or(test));
    (
        (epochs * trained) as f64 * train_seconds,
        scored as f64 * evaluate_seconds,
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use Recipe::{Published, Recommended};

    #[test]
    fn the_crowded_scene_takes_longest_and_limits_shorten_a_task() {
        let cost = |fold, train, test| {
            let (train, test) = expected(fold, Published, 20, train, test);
            train + test
        };
        let scoring = |fold| cost(fold, Some(100), None);
        assert!(scoring("univ") > scoring("zara2") && scoring("zara2") > scoring("hotel"));
        assert!(cost("eth", Some(10), Some(10)) < cost("eth", None, None));
        // By default the recommended recipe trains on equally many pedestrians in every fold.
        let trained = |fold| expected(fold, Recommended, 20, None, None).0.to_bits();
        assert_eq!(trained("eth"), trained("univ"));
    }
}
