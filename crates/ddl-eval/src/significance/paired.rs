//! The difference of two forecasters on the same windows.

use rand::RngExt as _;

use crate::significance::bootstrap::{PartialSum, RESAMPLES, generator, interval, mean};
use crate::significance::{BlockErrors, Interval};

/// Difference of the errors of two forecasters, window by window.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PairedDifference {
    /// First minus second, mean over the folds, m, with its 95 % interval over resampled blocks. Negative: the first is
    /// better.
    pub difference: Interval,
    /// Probability that chance alone makes a difference as large: the share of 10,000 random sign changes of the
    /// blocks' differences, two-sided, with the observed one included.
    pub p_value: f64,
}

/// Compares two forecasters on the same blocks, fold by fold.
///
/// `metric` is a sum of errors of a block, m. The null hypothesis of the test: both signs of the difference of a block
/// are equally likely. `None` without folds, with a fold of fewer than 10 blocks, and where the two have different
/// windows: their blocks differ in number, recording or pedestrians.
///
/// # References
/// Good, "Permutation, Parametric and Bootstrap Tests of Hypotheses", 2005, section 3.
pub fn paired_difference(
    first: &[&[BlockErrors]],
    second: &[&[BlockErrors]],
    metric: fn(&BlockErrors) -> f64,
) -> Option<PairedDifference> {
    if first.len() != second.len() {
        return None;
    }
    let of_fold = |(first, second): (&&[BlockErrors], &&[BlockErrors])| -> Option<Vec<PartialSum>> {
        let pairs = first.iter().zip(*second);
        let mut same = pairs.clone().map(|(a, b)| a.same_windows(b));
        (first.len() == second.len() && same.all(|same| same))
            .then(|| pairs.map(|(a, b)| PartialSum::of(metric(a) - metric(b), a)).collect())
    };
    let folds: Vec<_> = first.iter().zip(second).map(of_fold).collect::<Option<_>>()?;
    interval(&folds).map(|difference| PairedDifference { difference, p_value: p_value(&folds, difference.mean) })
}

fn p_value(folds: &[Vec<PartialSum>], observed: f64) -> f64 {
    // Sums in another order differ in their last bits, but must count as equal.
    let as_large = observed.abs() * (1.0 - 1e-12);
    let mut random = generator();
    let mut at_least = 1;
    for _ in 0..RESAMPLES {
        let means = folds.iter().map(|fold| {
            let flipped = fold
                .iter()
                .map(|part| PartialSum { sum: if random.random::<bool>() { part.sum } else { -part.sum }, ..*part });
            mean(flipped).unwrap_or(f64::NAN)
        });
        let difference = means.sum::<f64>() / folds.len() as f64;
        at_least += usize::from(difference.abs() >= as_large);
    }
    at_least as f64 / (RESAMPLES + 1) as f64
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;
    use crate::significance::blocks::blocks_of;
    use crate::significance::mean_interval;

    fn blocks(errors: &[f64]) -> Vec<BlockErrors> {
        blocks_of(4, errors)
    }

    fn compare(a: &[f64], b: &[f64]) -> PairedDifference {
        let (a, b) = (blocks(a), blocks(b));
        paired_difference(&[&a], &[&b], |block| block.min_ade).unwrap()
    }

    #[test]
    fn swapping_the_two_changes_the_sign_alone() {
        let (a, b) = ([0.2, 0.4, 0.3, 0.6, 0.1], [0.3, 0.3, 0.5, 0.6, 0.4]);
        let (a, b) = (a.repeat(2), b.repeat(2));
        let (there, back) = (compare(&a, &b), compare(&b, &a));
        assert_relative_eq!(there.difference.mean, -back.difference.mean);
        assert_relative_eq!(there.difference.low, -back.difference.high, epsilon = 1e-12);
        assert_relative_eq!(there.p_value, back.p_value);
    }

    /// Blocks of 1 to 7 pedestrians, 10 of one fold and 14 of another. `tests/reference/significance.py` prints the
    /// numbers; the p-value is that of all 2^24 patterns.
    #[test]
    fn uneven_blocks_of_two_folds_are_compared_as_computed_elsewhere() {
        let folds = |error: fn(f64, f64) -> f64| {
            [(0.0, 10_i64), (1.0, 14)].map(|(fold, count)| -> Vec<BlockErrors> {
                let block = |block: i64| {
                    let pedestrians = (1 + 3 * block % 7) as usize;
                    BlockErrors {
                        block,
                        min_fde: pedestrians as f64 * error(block as f64, fold),
                        ..blocks_of(pedestrians, &[0.0]).remove(0)
                    }
                };
                (0..count).map(block).collect()
            })
        };
        let first = folds(|b, fold| 0.1 * (5.0 * b % 11.0) + 0.2 * fold);
        let second = folds(|b, fold| 0.07 * (3.0 * b % 13.0) + 0.1 * fold);
        let (first, second) = (first.each_ref().map(Vec::as_slice), second.each_ref().map(Vec::as_slice));
        let compared = paired_difference(&first, &second, |block| block.min_fde).unwrap();
        let mean = mean_interval(&first, |block| block.min_fde).unwrap();
        for (found, mean, [low, high]) in [
            (mean, 0.681_785_714_285_714_2, [0.5046, 0.8367]),
            (compared.difference, 0.224_035_714_285_714_25, [0.0675, 0.3729]),
        ] {
            assert_relative_eq!(found.mean, mean, epsilon = 1e-12);
            assert_relative_eq!(found.low, low, epsilon = 0.006);
            assert_relative_eq!(found.high, high, epsilon = 0.006);
        }
        assert_relative_eq!(compared.p_value, 0.0149, epsilon = 0.004);
        // No pattern drawn is as extreme: the observed one counts.
        assert_relative_eq!(compare(&[0.1; 40], &[0.2; 40]).p_value, 1.0 / 10_001.0, epsilon = 1e-12);
        // Two of 1,024 patterns are as extreme, though their sums differ in the last bits.
        let second: Vec<f64> = (0..10).map(|i| 0.3 + 0.1 * f64::from(i)).collect();
        let first: Vec<f64> = second.iter().map(|error| error - 0.1).collect();
        assert_relative_eq!(compare(&first, &second).p_value, 2.0 / 1024.0, epsilon = 1.5e-3);
    }

    #[test]
    fn other_windows_and_too_few_blocks_are_not_compared() {
        let ten = blocks(&[0.1; 10]);
        let mut other = ten.clone();
        other[1].pedestrians = 5;
        let compared = |a: &[&[BlockErrors]], b: &[&[BlockErrors]]| paired_difference(a, b, |block| block.min_fde);
        assert!(compared(&[&ten], &[&ten]).is_some());
        for second in [&other[..], &ten[..9]] {
            assert_eq!(compared(&[&ten], &[second]), None);
        }
        assert_eq!(compared(&[&ten[..9]], &[&ten[..9]]), None);
        assert_eq!(compared(&[&ten], &[]), None);
        assert_eq!(compared(&[], &[]), None);
    }
}
