//! Quantiles that follow the scores of one place.
//!
//! A region of the level `a` with the right quantile `q` misses the share `1 - a` of the true positions. Each quantile
//! of the table is multiplied by `exp(shift)`, and each frame moves the shift by the share that the regions missed:
//!
//! ```text
//! shift += STEP * w * (missed - (1 - a))        w = share * min(sqrt(n), LARGEST_WEIGHT)
//! ```
//!
//! `missed` is the share of the `n` observed pedestrians outside their regions for this frame, `share` the time since
//! the frame before in steps of 0.4 s, at most 1. As long as no shift reaches its bound, the shift after some frames is
//! the sum of these moves. So the mean of `missed`, weighted by `w`, differs from `1 - a` by at most
//! `LARGEST_SHIFT / (STEP sum w)`, for any motion of the pedestrians. If the quantiles of two levels cross, they are
//! sorted; the bound then holds for the levels together.
//!
//! # References
//! - Gibbs and Candes, *Adaptive Conformal Inference Under Distribution Shift*, 2021.
//! - Angelopoulos, Candes and Tibshirani, *Conformal PID Control for Time Series Prediction*, 2023 (tracking of the
//!   quantile).

use std::sync::Arc;

use crate::position::HORIZON;
use crate::region_table::{LevelQuantiles, RegionTable};

/// Step size of a shift. Chosen with [`LARGEST_WEIGHT`] on recordings of other places (`docs/regions.md`).
const STEP: f64 = 0.06;
/// Weight of a frame with nine pedestrians or more. Outcomes come up to 12 steps late; with a larger weight the
/// quantiles of crowds oscillate.
const LARGEST_WEIGHT: f64 = 3.0;
/// ln 64: a quantile stays between 1/64 and 64 times that of the table, a radius between about 1/8 and 8 times.
const LARGEST_SHIFT: f64 = 4.158_883_083_359_672;
/// Smallest quantile that is multiplied, so that a quantile of 0 can grow.
const LEAST: f64 = 1e-3;

/// A table of quantiles with their learned shifts.
#[derive(Debug, Clone)]
pub(super) struct TrackedQuantiles {
    start: Arc<RegionTable>,
    /// `[levels][12]`, no unit.
    shifts: Vec<[f64; HORIZON]>,
    now: Arc<RegionTable>,
}

/// Scores of the positions at one frame under forecasts made `step` + 1 steps before it.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Outcomes {
    pub(super) step: usize,
    /// The table of their regions.
    pub(super) table: Arc<RegionTable>,
    /// One for each pedestrian.
    pub(super) scores: Vec<f64>,
}

impl TrackedQuantiles {
    /// The table with shifts of 0.
    #[must_use]
    pub(super) fn new(start: Arc<RegionTable>) -> Self {
        Self {
            shifts: vec![[0.0; HORIZON]; start.0.levels.len()],
            now: Arc::clone(&start),
            start,
        }
    }

    /// The current quantiles.
    pub(super) fn table(&self) -> &Arc<RegionTable> {
        &self.now
    }

    /// Learns from all outcomes of one frame, `share` of a step (0 to 1) after the frame before.
    pub(super) fn learn(&mut self, outcomes: &[Outcomes], share: f64) {
        for Outcomes { step, table, scores } in outcomes {
            let count = scores.len() as f64;
            let weight = share * count.sqrt().min(LARGEST_WEIGHT);
            let LevelQuantiles { levels, quantiles } = &table.0;
            let rows = levels.iter().zip(quantiles).zip(&mut self.shifts);
            for ((level, quantiles), shifts) in rows {
                let missed = scores.iter().filter(|&&score| score > quantiles[*step]);
                let missed = missed.count() as f64 / count;
                let moved = shifts[*step] + STEP * weight * (missed - (1.0 - level));
                shifts[*step] = moved.clamp(-LARGEST_SHIFT, LARGEST_SHIFT);
            }
        }
        if !outcomes.is_empty() {
            self.now = shifted(&self.start, &self.shifts).into();
        }
    }
}

/// The quantiles times the exponentials of their shifts, in ascending order over the levels.
fn shifted(start: &RegionTable, shifts: &[[f64; HORIZON]]) -> RegionTable {
    let LevelQuantiles { levels, quantiles } = &start.0;
    let mut moved: Vec<[f64; HORIZON]> = quantiles
        .iter()
        .zip(shifts)
        .map(|(row, shifts)| std::array::from_fn(|t| row[t].max(LEAST) * shifts[t].exp()))
        .collect();
    for t in 0..HORIZON {
        let mut column: Vec<f64> = moved.iter().map(|row| row[t]).collect();
        column.sort_by(f64::total_cmp);
        for (row, quantile) in moved.iter_mut().zip(column) {
            row[t] = quantile;
        }
    }
    RegionTable(LevelQuantiles {
        levels: levels.clone(),
        quantiles: moved,
    })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test may panic")]

    use std::collections::VecDeque;

    use proptest::{collection::vec, prelude::*};

    use super::*;

    fn table(rows: &[(f64, f64)]) -> Arc<RegionTable> {
        let columns = LevelQuantiles {
            levels: rows.iter().map(|row| row.0).collect(),
            quantiles: rows.iter().map(|row| [row.1; HORIZON]).collect(),
        };
        Arc::new(columns.try_into().unwrap())
    }

    /// The numbers come from a Python program, written from the formula at the head of this file.
    #[test]
    fn five_frames_as_computed_elsewhere() {
        let mut tracked = TrackedQuantiles::new(table(&[(0.5, 1.0), (0.9, 4.0)]));
        let frames: [(f64, &[f64], [f64; 2]); 5] = [
            (1.0, &[0.5, 2.0, 5.0], [1.017_471_377_864, 4.098_180_408_623]),
            (0.5, &[6.0], [1.032_848_488_542, 4.210_338_601_735]),
            (1.0, &[0.1; 16], [0.943_952_443_339, 4.135_230_507_658]),
            (1.0, &[9.0, 9.0, 0.2, 1.5], [0.972_700_075_075, 4.338_562_501_638]),
            (0.25, &[3.0, 0.9], [0.972_700_075_075, 4.329_368_775_608]),
        ];
        for (share, scores, expected) in frames {
            let outcomes = Outcomes {
                step: 0,
                table: Arc::clone(tracked.table()),
                scores: scores.to_vec(),
            };
            tracked.learn(&[outcomes], share);
            for (level, expected) in [0.5, 0.9].into_iter().zip(expected) {
                let quantile = tracked.table().quantile(level, 0).unwrap();
                assert!((quantile - expected).abs() < 1e-12, "{quantile} {expected}");
                let untouched = tracked.table().quantile(level, 1);
                assert_eq!(untouched, tracked.start.quantile(level, 1));
            }
        }
    }

    /// One frame: for each observed pedestrian, whether it is missed, and its distance from the edge.
    type Judged = Vec<(bool, f64)>;

    proptest! {
        /// An adversary that knows the region cannot move the weighted mean beyond the bound, if the scores stay within
        /// a factor of 7 of the table's quantile. Then no shift reaches its bound.
        #[test]
        fn the_share_missed_is_bounded_for_any_stream(
            level in 0.05..0.95f64,
            t in 0..HORIZON,
            frames in vec((vec((any::<bool>(), 1.0..1.5f64), 1..20), 0.1..1.0f64), 1..600),
            run in 1..50usize,
        ) {
            let base = 2.0;
            let mut tracked = TrackedQuantiles::new(table(&[(level, base)]));
            let mut issued = VecDeque::from(vec![Arc::clone(tracked.table()); t + 1]);
            let (mut error, mut weights) = (0.0, 0.0);
            for (at, (judged, share)) in frames.iter().enumerate() {
                let judged: &Judged = judged;
                let table = issued.pop_front().unwrap();
                let edge = table.quantile(level, t).unwrap();
                // Runs in which all regions miss, or no region misses, move the quantile furthest.
                let mood = (at / run) % 3;
                let score = |&(coin, by): &(bool, f64)| {
                    let misses = if mood == 2 { coin } else { mood == 0 };
                    let wanted = if misses { edge * by } else { edge / by };
                    wanted.clamp(base / 7.0, base * 7.0)
                };
                let scores: Vec<f64> = judged.iter().map(score).collect();
                let missed = scores.iter().filter(|&&score| score > edge).count();
                let weight = share * (scores.len() as f64).sqrt().min(3.0);
                error += weight * (missed as f64 / scores.len() as f64 - (1.0 - level));
                weights += weight;
                tracked.learn(&[Outcomes { step: t, table, scores }], *share);
                issued.push_back(Arc::clone(tracked.table()));
            }
            prop_assert!((error / weights).abs() <= LARGEST_SHIFT / (STEP * weights) + 1e-9);
        }

        #[test]
        fn quantiles_stay_within_their_bounds_and_in_order(
            scores in vec(prop_oneof![Just(0.0), 0.0..20.0f64, Just(1e300)], 1..400),
            rows in Just([(0.2, 0.0), (0.5, 1.0), (0.9, 4.0)]),
        ) {
            let mut tracked = TrackedQuantiles::new(table(&rows));
            for (at, score) in scores.iter().enumerate() {
                let step = at % HORIZON;
                let table = Arc::clone(tracked.table());
                tracked.learn(&[Outcomes { step, table, scores: vec![*score; 9] }], 1.0);
                let quantile = |level| tracked.table().quantile(level, step).unwrap();
                let [low, middle, high] = [0.2, 0.5, 0.9].map(quantile);
                prop_assert!(low > 0.0 && low <= middle && middle <= high && high <= 256.1);
            }
        }
    }
}
