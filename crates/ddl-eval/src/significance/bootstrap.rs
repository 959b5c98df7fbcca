//! Intervals by resampling blocks.

use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

use crate::significance::BlockErrors;

/// Resamples drawn for an interval, and sign changes for a test.
pub(crate) const RESAMPLES: usize = 10_000;

/// Fewest blocks of a fold: fewer blocks give no reliable spread.
pub(crate) const MIN_BLOCKS: usize = 10;

/// Seed of the resamples: the same in every report, so that reports are reproducible bit by bit.
const SEED: u64 = 0;

/// A mean and the interval that holds 95 % of its resamples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interval {
    /// The mean itself.
    pub mean: f64,
    /// The 2.5th percentile of the resamples.
    pub low: f64,
    /// Their 97.5th percentile.
    pub high: f64,
}

/// The unweighted mean over the folds of the mean error of each fold, with its 95 % percentile interval over resampled
/// blocks, m.
///
/// `folds[f]` are the blocks of fold f, and `metric` is a sum of errors of a block, m. In each of 10,000 resamples
/// every fold draws as many of its blocks as it has, with replacement; its mean is that of the pedestrians in them.
/// `None` without folds, or with a fold of fewer than 10.
pub fn mean_interval(folds: &[&[BlockErrors]], metric: fn(&BlockErrors) -> f64) -> Option<Interval> {
    let folds: Vec<Vec<PartialSum>> =
        folds.iter().map(|blocks| blocks.iter().map(|b| PartialSum::of(metric(b), b)).collect()).collect();
    interval(&folds)
}

#[derive(Debug, Clone, Copy)]
pub(super) struct PartialSum {
    pub(super) sum: f64,
    pub(super) pedestrians: usize,
}

impl PartialSum {
    pub(super) fn of(sum: f64, block: &BlockErrors) -> Self {
        Self { sum, pedestrians: block.pedestrians }
    }
}

pub(super) fn interval(folds: &[Vec<PartialSum>]) -> Option<Interval> {
    if folds.iter().any(|fold| fold.len() < MIN_BLOCKS) {
        return None;
    }
    let means: Option<Vec<f64>> = folds.iter().map(|fold: &Vec<PartialSum>| mean(fold.iter().copied())).collect();
    let mean_of = |means: &[f64]| means.iter().sum::<f64>() / means.len() as f64;
    let means = means.filter(|means| !means.is_empty())?;
    let mut random = generator();
    let mut resamples: Vec<f64> = (0..RESAMPLES)
        .map(|_| {
            let drawn: Vec<f64> = folds
                .iter()
                .map(|fold| {
                    let draw = (0..fold.len()).map(|_| fold[random.random_range(0..fold.len())]);
                    // Every block has pedestrians, so every resample has a mean.
                    mean(draw).unwrap_or(f64::NAN)
                })
                .collect();
            mean_of(&drawn)
        })
        .collect();
    resamples.sort_by(f64::total_cmp);
    Some(Interval { mean: mean_of(&means), low: percentile(&resamples, 0.025), high: percentile(&resamples, 0.975) })
}

pub(super) fn generator() -> ChaCha8Rng {
    ChaCha8Rng::seed_from_u64(SEED)
}

pub(super) fn mean(parts: impl Iterator<Item = PartialSum>) -> Option<f64> {
    let (sum, pedestrians) = parts.fold((0.0, 0), |(sum, count), part| (sum + part.sum, count + part.pedestrians));
    (pedestrians > 0).then(|| sum / pedestrians as f64)
}

/// The quantile of sorted values, interpolated linearly.
fn percentile(sorted: &[f64], share: f64) -> f64 {
    let place = share * (sorted.len() - 1) as f64;
    let below = place.floor() as usize;
    let above = (below + 1).min(sorted.len() - 1);
    sorted[below] + (place - below as f64) * (sorted[above] - sorted[below])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The values of numpy.percentile.
    #[test]
    #[expect(clippy::float_cmp, reason = "quarters of small integers are exact")]
    fn percentiles_lie_between_two_values_by_proportion() {
        let sorted = [1.0, 2.0, 4.0, 8.0, 16.0];
        let expected = [(0.0, 1.0), (0.25, 2.0), (0.3125, 2.5), (0.9375, 14.0), (1.0, 16.0)];
        for (share, expected) in expected {
            assert_eq!(percentile(&sorted, share), expected, "{share}");
        }
        assert_eq!(percentile(&[3.0], 0.975), 3.0);
    }
}
