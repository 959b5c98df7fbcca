//! The expectation, over the noise, of the metric that the output layer emits.

use crate::forecast::own_frame::SMALLEST_PIVOT;

/// Entries of C = W W^T, the covariance of W n for noise n ~ N(0, I).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct NoiseSpread {
    c11: f32,
    c12: f32,
    c22: f32,
}

impl NoiseSpread {
    /// From the weight of the output layer, `[3, inputs]`, whose last `noise` columns multiply the noise.
    pub(super) fn of(weight: &[f32], inputs: usize, noise: usize) -> Self {
        let row = |i: usize| &weight[i * inputs..][inputs - noise..inputs];
        let c = |i: usize, j: usize| -> f32 { row(i).iter().zip(row(j)).map(|(a, b)| a * b).sum() };
        Self { c11: c(0, 0), c12: c(0, 1), c22: c(1, 1) + c(2, 2) }
    }

    /// The Cholesky factor of E[L L^T] when noise adds W n to (a, b, c).
    ///
    /// The output is linear in the noise, so E[L L^T] = L0 L0^T + E[D D^T] with D built from W n. L0 L0^T alone would
    /// give speeds that are too low.
    pub(super) fn expected_factor(self, [a, b, c]: [f32; 3]) -> [f32; 3] {
        let first = (a * a + self.c11).max(SMALLEST_PIVOT).sqrt();
        let below = (a * b + self.c12) / first;
        let rest = b * b + c * c + self.c22 - below * below;
        [first, below, rest.max(SMALLEST_PIVOT).sqrt()]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt as _, SeedableRng as _};
    use rand_chacha::ChaCha8Rng;
    use rand_distr::StandardNormal;

    #[test]
    fn the_expected_factor_is_that_of_the_mean_metric() {
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        let (features, noise) = (2, 16);
        let inputs = features + noise;
        let mut normal = |scale: f32| -> f32 { scale * rng.sample::<f32, _>(StandardNormal) };
        let mean: [f32; 3] = std::array::from_fn(|_| normal(1.0));
        let weight: Vec<f32> = (0..3 * inputs).map(|_| normal(0.1)).collect();
        let metric = |[a, b, c]: [f32; 3]| [a * a, a * b, b * b + c * c].map(f64::from);
        let draws = 200_000;
        let mut sums = [0.0; 3];
        for _ in 0..draws {
            let noise: [f32; 16] = std::array::from_fn(|_| normal(1.0));
            let emitted = std::array::from_fn(|i| {
                let row = &weight[i * inputs + features..(i + 1) * inputs];
                mean[i] + row.iter().zip(noise).map(|(w, n)| w * n).sum::<f32>()
            });
            for (sum, entry) in sums.iter_mut().zip(metric(emitted)) {
                *sum += entry / f64::from(draws);
            }
        }
        let spread = NoiseSpread::of(&weight, inputs, noise);
        let expected = metric(spread.expected_factor(mean));
        // The standard error of the sampled mean is about 3e-3.
        for (sampled, expected) in sums.into_iter().zip(expected) {
            assert!((sampled - expected).abs() < 1.5e-2, "{sampled} {expected}");
        }
    }
}
