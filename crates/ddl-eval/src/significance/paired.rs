//! The difference of two forecasters on the same windows.

use rand::RngExt as _;

use crate::significance::bootstrap::{PartialSum, RESAMPLES, generator, interval, mean};
use crate::significance::{BlockErrors, BlockMetric, Interval};

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

/// The two were not measured on the same blocks.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "the two results have different windows: fold {fold}, {what}; measure both on the same recordings, window rule \
     and subset"
)]
pub struct DifferentWindowsError {
    fold: usize,
    what: String,
}

/// Compares two forecasters on the same blocks, fold by fold.
///
/// The null hypothesis of the test: both signs of the difference of a block are equally likely. `None` without folds,
/// or with a fold of fewer than 10 blocks.
///
/// # Errors
/// The blocks of the two differ in number, recording or pedestrians.
///
/// # References
/// Good, "Permutation, Parametric and Bootstrap Tests of Hypotheses", 2005, section 3.
pub fn paired_difference(
    first: &[&[BlockErrors]],
    second: &[&[BlockErrors]],
    metric: BlockMetric,
) -> Result<Option<PairedDifference>, DifferentWindowsError> {
    let unpaired = |fold, what: String| Err(DifferentWindowsError { fold, what });
    if first.len() != second.len() {
        let (a, b) = (first.len(), second.len());
        return unpaired(a.min(b), format!("{a} folds against {b}"));
    }
    let mut folds: Vec<Vec<PartialSum>> = Vec::with_capacity(first.len());
    for (fold, (a, b)) in first.iter().zip(second).enumerate() {
        if a.len() != b.len() {
            return unpaired(fold, format!("{} blocks against {}", a.len(), b.len()));
        }
        let mut parts = Vec::with_capacity(a.len());
        for (a, b) in a.iter().zip(*b) {
            let place = |block: &BlockErrors| {
                format!(
                    "block {} of {} with {} pedestrians",
                    block.block, block.recording, block.pedestrians
                )
            };
            if !a.same_windows(b) {
                return unpaired(fold, format!("{} against {}", place(a), place(b)));
            }
            parts.push(PartialSum::of(a.sum(metric) - b.sum(metric), a));
        }
        folds.push(parts);
    }
    Ok(interval(&folds).map(|difference| PairedDifference {
        difference,
        p_value: p_value(&folds, difference.mean),
    }))
}

fn p_value(folds: &[Vec<PartialSum>], observed: f64) -> f64 {
    // Sums in another order differ in their last bits, but must count as equal.
    let as_large = observed.abs() * (1.0 - 1e-12);
    let mut random = generator();
    let mut at_least = 1;
    for _ in 0..RESAMPLES {
        let means = folds.iter().map(|fold| {
            let flipped = fold.iter().map(|part| PartialSum {
                sum: if random.random::<bool>() { part.sum } else { -part.sum },
                ..*part
            });
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

    fn blocks(errors: &[f64]) -> Vec<BlockErrors> {
        blocks_of(4, errors)
    }

    fn compare(a: &[f64], b: &[f64]) -> PairedDifference {
        let (a, b) = (blocks(a), blocks(b));
        let compared = paired_difference(&[&a], &[&b], BlockMetric::MinAde);
        compared.unwrap().unwrap()
    }

    /// Every one of ten blocks is better by the same 0.1 m: of the 1,024 patterns of signs, two are as extreme.
    #[test]
    fn a_difference_in_every_block_is_hardly_chance() {
        let second: Vec<f64> = (0..10).map(|i| 0.3 + 0.1 * f64::from(i)).collect();
        let first: Vec<f64> = second.iter().map(|error| error - 0.1).collect();
        let compared = compare(&first, &second);
        assert_relative_eq!(compared.difference.mean, -0.1, epsilon = 1e-12);
        assert_relative_eq!(compared.difference.low, -0.1, epsilon = 1e-12);
        assert_relative_eq!(compared.p_value, 2.0 / 1024.0, epsilon = 1.5e-3);
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

    #[test]
    fn other_windows_are_refused_with_their_place() {
        let (a, mut b) = (blocks(&[0.1, 0.2]), blocks(&[0.1, 0.2]));
        b[1].pedestrians = 5;
        let error = paired_difference(&[&a], &[&b], BlockMetric::MinFde).unwrap_err();
        assert!(error.to_string().contains("block 1 of a with 4 pedestrians against"));
        let error = paired_difference(&[&a], &[&b[..1]], BlockMetric::MinFde).unwrap_err();
        assert!(error.to_string().contains("2 blocks against 1"), "{error}");
        assert!(paired_difference(&[&a], &[], BlockMetric::MinFde).is_err());
        assert_eq!(paired_difference(&[], &[], BlockMetric::MinFde), Ok(None));
    }
}
