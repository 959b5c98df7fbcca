//! How much there is to compute: multiplications and additions, counted from the configuration.

use crate::config::StarConfig;
use ddl_data::{HORIZON, OBSERVED, WINDOW};

/// A product of matrices takes a multiplication and an addition for each pair of numbers that meet.
const MULTIPLY_AND_ADD: u64 = 2;
/// A backward pass multiplies twice where a forward pass does once: for the inputs and for the weights.
const WITH_BACKWARD: u64 = 3;

impl StarConfig {
    /// Multiplications and additions of a forecast: 8 observed frames and 12 steps, `hypotheses` goals for each of the
    /// `pedestrians` of one scene.
    ///
    /// Counted are the matrix products of the network, as [`forecast_windows`](crate::ForecastWindows::forecast_windows)
    /// shares them among the hypotheses; everything else (normalisation, softmax, the flow) is a small part of them. With w the width
    /// of a token, f that of the feed-forward blocks, a token that looks at k tokens costs in an encoder layer
    /// `2 (4 w² + 2 k w + 2 w f)`. A pedestrian is taken to look at everybody in the scene.
    ///
    /// # Examples
    /// ```
    /// use ddl_network::{StarConfig, Variant};
    /// let published = StarConfig::published(Variant::Full);
    /// assert_eq!(published.forecast_operations(1, 1), 31_117_312);
    /// ```
    pub fn forecast_operations(&self, pedestrians: usize, hypotheses: usize) -> u64 {
        let (n, all) = (pedestrians as u64, hypotheses as u64);
        // Where positions are relative to the goal, the observed frames differ between the hypotheses.
        let observed = if self.variant.goal_shift() { all } else { 1 };
        let steps = |t: std::ops::Range<usize>| -> u64 { t.map(|t| self.step(t, n)).sum() };
        let (before, after) = (0..OBSERVED, OBSERVED..WINDOW - 1);
        let spatial = (before.len() as u64 + all * after.len() as u64) * self.spatial_token(n);
        let temporal = observed * steps(before) + all * steps(after);
        // The expectation over the noise takes its share of the weights alone, once.
        let output = all * HORIZON as u64 * self.product(self.model_width, self.output_width());
        n * (spatial + temporal + output)
    }

    /// Multiplications and additions of a training step, forwards and backwards, on a batch of scenes of so many pedestrians each.
    ///
    /// Counted as in [`forecast_operations`](Self::forecast_operations), 19 frames a pedestrian, and three times: what is computed
    /// again on the way back is not counted again.
    pub fn training_operations(&self, scenes: &[usize]) -> u64 {
        let steps = WINDOW as u64 - 1;
        let output = self.product(self.output_inputs() + self.noise_width, self.output_width());
        let of_scene = |&pedestrians: &usize| {
            let n = pedestrians as u64;
            let temporal: u64 = (0..WINDOW - 1).map(|t| self.step(t, n)).sum();
            n * (steps * (self.spatial_token(n) + output) + temporal)
        };
        WITH_BACKWARD * scenes.iter().map(of_scene).sum::<u64>()
    }

    /// One token of a frame: embedding and first spatial encoder, among n pedestrians.
    fn spatial_token(&self, n: u64) -> u64 {
        self.product(2, self.model_width) + self.spatial_layers as u64 * self.layer(n)
    }

    /// One token of frame t: both temporal encoders over it and the t before, fusion, the second spatial encoder among n
    /// pedestrians, and what both temporal encoders remember of it.
    fn step(&self, t: usize, n: u64) -> u64 {
        let width = self.model_width;
        self.product(self.temporal_inputs(), width)
            + 2 * self.layer(t as u64 + 1)
            + self.product(2 * width, width)
            + self.spatial_layers as u64 * self.layer(n)
            + 2 * self.product(width, 2 * width)
    }

    /// One token in an encoder layer, looking at `keys` tokens.
    fn layer(&self, keys: u64) -> u64 {
        let width = self.model_width;
        self.product(width, 3 * width) // query, key and value
            + 2 * keys * self.product(1, width) // scores, and the mixture of the values
            + self.product(width, width)
            + 2 * self.product(width, self.feed_forward_width)
    }

    /// A vector of `from` numbers times a matrix, to `to` numbers.
    #[expect(clippy::unused_self, reason = "reads as one of the parts")]
    fn product(&self, from: i64, to: i64) -> u64 {
        MULTIPLY_AND_ADD * from as u64 * to as u64
    }
}

#[cfg(test)]
mod tests {
    use crate::config::{StarConfig, Variant};

    /// Small enough to count by hand.
    fn small(variant: Variant) -> StarConfig {
        StarConfig {
            model_width: 4,
            heads: 2,
            feed_forward_width: 3,
            spatial_layers: 1,
            noise_width: 2,
            ..StarConfig::published(variant)
        }
    }

    /// A layer: 2 (4 12 + 4 4 + 2 4 3) = 176, and 16 for every key. Embedding 16, fusion 64, remembering 2 64, output 24.
    ///
    /// One pedestrian, one goal: spatial tokens 19 (16 + 192); steps 19 (16 + 64 + 128 + 192) and, in the temporal layers,
    /// 2 (19 176 + 16 (1 + .. + 19)); outputs 12 24. A second goal shares the spatial tokens of 8 observed frames and,
    /// without goal shift, their steps; a second pedestrian is 16 more for each in each of two spatial layers and 19 frames.
    #[test]
    fn forecasts_by_hand() {
        let one = 19 * 208 + 19 * 400 + 2 * (19 * 176 + 16 * 190) + 12 * 24;
        assert_eq!(one, 24_608);
        let before = 8 * 400 + 2 * (8 * 176 + 16 * 36);
        let after = 11 * 400 + 2 * (11 * 176 + 16 * 154);
        for (variant, observed) in [(Variant::Full, 2), (Variant::NoGoalShift, 1)] {
            let operations =
                |pedestrians, goals| small(variant).forecast_operations(pedestrians, goals);
            assert_eq!(operations(1, 1), one);
            assert_eq!(operations(2, 1), 2 * (one + 19 * 2 * 16));
            let two_goals = (8 + 2 * 11) * 208 + observed * before + 2 * after + 2 * 12 * 24;
            assert_eq!(operations(1, 2), two_goals);
        }
    }

    /// The output reads two numbers of noise: 36 instead of 24, at 19 frames. Three times for the way back.
    #[test]
    fn a_training_step_by_hand() {
        let operations = |scenes: &[usize]| small(Variant::Full).training_operations(scenes);
        let one = 3 * (24_608 - 12 * 24 + 19 * 36);
        assert_eq!(operations(&[1]), one);
        assert_eq!(operations(&[1, 1]), 2 * one);
        assert_eq!(operations(&[2]), 2 * (one + 3 * 19 * 2 * 16));
    }
}
