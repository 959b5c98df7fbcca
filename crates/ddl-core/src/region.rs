//! Regions that contain a pedestrian with a given probability.
//!
//! With the weights `w_k` and positions `p_k` of the hypotheses at one step, and the [scale](crate::Spread) `s` around
//! them, the score of a position `x` is
//!
//! ```text
//! score(x) = min_k |x - p_k|^2 / (2 s^2) - ln(w_k / max w)        no unit
//! ```
//!
//! The region of a level is the set of positions whose score is at most `q`. Here `q` is the quantile of this level of
//! the scores of true positions of this pace in separate calibration recordings (split-conformal prediction). It is one
//! disc around each hypothesis, of radius `s sqrt(2 (q + ln(w_k / max w)))`, and no disc if the root is not real. The
//! coverage holds on average over places like those of the calibration. Scores from the density of Student's t instead
//! give regions of the same size (`docs/tried.md`).
//!
//! # References
//! Vovk et al., *Algorithmic Learning in a Random World*, 2005 (split-conformal prediction).

mod adaptive;
mod powers;
mod tracked;
mod whole;

use crate::forecast::Forecast;
use crate::position::Position;
use crate::region_table::Disc;

pub use adaptive::AdaptiveRegions;
pub use whole::Holding;
pub(crate) use whole::Wholes;

impl Forecast {
    /// The score of the position `at` (m) of pedestrian `i`, `t` + 1 steps ahead; `None` for forecasts without a
    /// [spread](crate::Spread).
    pub(crate) fn region_score(&self, i: usize, t: usize, position: Position) -> Option<f64> {
        let scale = self.scale(i, t)?;
        let heaviest = self.weight(i, self.most_likely(i));
        let of_hypothesis = |k: usize| {
            let p = self.hypothesis(i, k)[t];
            let off = [0, 1].map(|axis| (position[axis] - p[axis]) / scale);
            0.5 * (off[0] * off[0] + off[1] * off[1]) - (self.weight(i, k) / heaviest).ln()
        };
        (0..self.hypotheses()).map(of_hypothesis).reduce(f64::min)
    }

    fn region_quantile(&self, i: usize, t: usize, level: f64) -> Option<f64> {
        self.regions()?.quantile(self.pace(i)?, level, t)
    }

    /// ln of the weight of a hypothesis, relative to the most likely one of the pedestrian.
    fn log_weight(&self, i: usize, k: usize) -> f64 {
        (self.weight(i, k) / self.weight(i, self.most_likely(i))).ln()
    }

    /// The radius (m) of the disc around hypothesis `k` of pedestrian `i`, `t` + 1 steps ahead, in the region of a
    /// level; `None` without a disc.
    pub fn region_radius(&self, i: usize, k: usize, t: usize, level: f64) -> Option<f64> {
        let quantile = self.region_quantile(i, t, level)?;
        let left = quantile + self.log_weight(i, k);
        (left >= 0.0).then(|| self.scale(i, t).map(|scale| scale * (2.0 * left).sqrt()))?
    }

    /// The region that contains pedestrian `i`, `t` + 1 steps ahead, with the probability `level`. It has at most one
    /// disc for each hypothesis, and always one for the most likely. `None` beyond the range of the table, and without
    /// regions.
    pub fn region(&self, i: usize, t: usize, level: f64) -> Option<Vec<Disc>> {
        self.region_quantile(i, t, level)?;
        let disc = |k: usize| {
            let radius = self.region_radius(i, k, t, level)?;
            let centre = self.hypothesis(i, k)[t];
            Some(Disc { centre, radius })
        };
        Some((0..self.hypotheses()).filter_map(disc).collect())
    }
}

#[cfg(test)]
mod tests {
    use proptest::{collection::vec, prelude::*};

    use super::*;
    use crate::forecast::Spread;
    use crate::pace::Pace;
    use crate::position::HORIZON;
    use crate::region_table::RegionTable;

    proptest! {
        #[test]
        fn the_region_is_where_the_score_is_small(
            ends in vec([-3.0..3.0f64, -3.0..3.0f64], 5),
            raw in vec(0.01..1.0f64, 5),
            truths in vec([-4.0..4.0f64, -4.0..4.0f64], 40),
            spread in 0.1..2.0f64,
            level in 0.1..0.95f64,
        ) {
            let total: f64 = raw.iter().sum();
            let weights = raw.iter().map(|w| w / total).collect();
            let positions = ends.iter().flat_map(|&end| [end; HORIZON]).collect();
            let bare = Forecast::new(1, 5, positions, weights, None).unwrap();
            let with = |scores: &[[f64; HORIZON]]| {
                let regions = RegionTable::of(&[scores; 3], &[level]).unwrap().into();
                let (scales, paces) = (vec![spread; HORIZON], vec![Pace::Slow]);
                bare.clone().with_spread(Spread { scales, paces, regions }).unwrap()
            };
            let any = with(&[[1.0; HORIZON]; 40]);
            let scores: Vec<[f64; HORIZON]> = truths
                .iter()
                .map(|&truth| std::array::from_fn(|t| any.region_score(0, t, truth).unwrap()))
                .collect();
            let forecast = with(&scores);
            let region = forecast.region(0, 5, level).unwrap();
            prop_assert!(!region.is_empty());
            let quantile = forecast.region_quantile(0, 5, level).unwrap();
            let mut inside = 0;
            for (&at, score) in truths.iter().zip(&scores) {
                // The score on the edge may be on either side.
                if (score[5] - quantile).abs() > 1e-9 {
                    let inside = region.iter().any(|disc| disc.contains(at));
                    prop_assert_eq!(inside, score[5] < quantile);
                }
                inside += usize::from(score[5] <= quantile);
            }
            let least = (level * 41.0).ceil().min(40.0) as usize;
            prop_assert_eq!(inside, least);
        }
    }
}
