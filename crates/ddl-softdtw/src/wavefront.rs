//! The recursion of soft-DTW in the exponential domain, four rows at a time along antidiagonals.
//!
//! With R(i, j) = exp(−r(i, j)/γ) the smoothed minimum is a sum,
//!
//! ```text
//! R(i, j) = 2^−t(i, j) · ( R(i−1, j−1) + R(i−1, j) + R(i, j−1) ),   t = δ log2(e) / γ,
//! ```
//!
//! so a cell needs one exponential and no logarithm. R is held as `significand · 2^exponent`, the exponent an exact
//! integer: nothing cancels and nothing underflows. Short sequences with small costs do without the exponent, and give
//! the same bits.
//!
//! # Error
//! To first order in u = 2^−53, the relative error of R is at most the largest over paths of the sum of those of its cells:
//! (D + 5) u t ln 2 for t itself (D components), 2.1 u for 2^−t, 3 u for the two sums and the product. At most n + m − 1
//! cells make a path, and the mean of the cost over paths, weighted by exp(−cost/γ), exceeds the value by γ times their
//! entropy, at most γ ln(paths) < 0.9 γ (n + m). The logarithm and the last two products add 5 u |v| + 3 u γ. In all
//! less than (D + 12) u (|v| + γ (n + m)).
//!
//! # Order
//! Four consecutive rows (a strip) advance together, each one column behind the row above it: the cells of a step are
//! independent of each other. One row is kept between strips.
#![expect(
    clippy::inline_always,
    reason = "the lanes stay in registers only when what works on them is inlined"
)]

use crate::cost::{Cost, Length, Metric, Squared};
use crate::exp2::{Lanes, STRIP};
use crate::grid::{Grid, Strip};
use crate::scalar::Scalar;
use crate::weight::{Plain, Scaled, Weight};

/// Exponents are exact integers while the whole parts of all t along a path sum to no more than this.
const EXACT: f64 = 4_503_599_627_370_496.0; // 2^52
/// Plain numbers suffice while all t along a path sum to no more than this: R is then at least 2^−700, and for sequences
/// that fit on the stack it is at most 3^64 = 2^102.
const PLAIN: f64 = 700.0;
/// Entries of the working memory that fit on the stack.
const SHORT: usize = 32;
/// Significands are brought back to [1, 2) every so many columns and rows. Between two of these a path has at most 2 · 128
/// cells, an antidiagonal each, and each multiplies the significand by 2^−1/2 to (1 + √2) √2 < 2^1.78: in all by
/// 2^−128 to 2^456, which leaves room for addends that are 2^700 smaller.
const STRETCH: usize = 128;

/// Receives what the backward recursion needs of each step of each strip.
pub(crate) trait StepRecord {
    /// The addends of each cell, from (i−1, j−1), (i−1, j) and (i, j−1), and their sums.
    fn step(&mut self, addends: &[Lanes; 3], sums: &Lanes);

    /// Forget every step: the recursion begins again.
    fn restart(&mut self);
}

pub(crate) struct Forget;

impl StepRecord for Forget {
    #[inline(always)]
    fn step(&mut self, _: &[Lanes; 3], _: &Lanes) {}

    fn restart(&mut self) {}
}

impl<T: Scalar, const D: usize> Grid<'_, T, D> {
    /// The soft-DTW value, or `None` where costs are so large against γ that the log domain must be used.
    pub(crate) fn value(&self, record: &mut impl StepRecord) -> Option<f64> {
        let scale = std::f64::consts::LOG2_E / self.gamma;
        if !scale.is_finite() {
            return None;
        }
        // Entry c + 3 is column c. A step reads entry d + 3 (column d) for its first lane and writes entry d (column d − 3)
        // from its last; three entries before and after the columns take what the slanted ends of a strip read and write.
        let length = self.columns.len() + 2 * (STRIP - 1);
        let path = (self.rows.len() + self.columns.len()) as f64;
        let mut end = None;
        if length <= SHORT && self.rows.len() <= SHORT {
            let row = &mut [Plain::NONE_ONE; SHORT][..length];
            end = self.run::<Plain>(scale, PLAIN / path, row, record);
            if end.is_none() {
                record.restart();
            }
        }
        if end.is_none() {
            let mut short = [Scaled::NONE_ONE; SHORT];
            let mut long = Vec::new();
            let row = if length <= SHORT {
                &mut short[..length]
            } else {
                long.resize(length, Scaled::NONE_ONE);
                &mut long
            };
            end = self.run::<Scaled<Lanes>>(scale, EXACT / path, row, record);
        }
        let (significand, exponent) = end?;
        Some(-self.gamma * (exponent * std::f64::consts::LN_2 + significand.ln()))
    }

    /// R of the last cell as significand and exponent, or `None` when some t exceeds `limit`.
    fn run<W: Weight>(
        &self,
        scale: f64,
        limit: f64,
        row: &mut [W::One],
        record: &mut impl StepRecord,
    ) -> Option<(f64, f64)> {
        let mut largest = [0.0; STRIP];
        for index in 0..self.strips() {
            let strip = self.strip(index);
            let t_max = &mut largest;
            match (self.cost, self.band) {
                (Cost::SquaredEuclidean, None) => {
                    self.advance::<W, _, false>(Squared, &strip, scale, row, t_max, record);
                }
                (Cost::SquaredEuclidean, Some(_)) => {
                    self.advance::<W, _, true>(Squared, &strip, scale, row, t_max, record);
                }
                (Cost::Euclidean, None) => {
                    self.advance::<W, _, false>(Length, &strip, scale, row, t_max, record);
                }
                (Cost::Euclidean, Some(_)) => {
                    self.advance::<W, _, true>(Length, &strip, scale, row, t_max, record);
                }
            }
            if largest.iter().any(|&t| t > limit) {
                return None;
            }
            if (index + 1) % (STRETCH / STRIP) == 0 {
                for cell in &mut *row {
                    *cell = W::normalised_one(*cell);
                }
            }
        }
        Some(W::parts(row[self.columns.len() + STRIP - 2]))
    }

    /// One strip: `row` holds the row above it before, its last row after. `largest` takes the largest t of each lane.
    #[inline(always)]
    fn advance<W: Weight, M: Metric, const BANDED: bool>(
        &self,
        metric: M,
        strip: &Strip<D>,
        scale: f64,
        row: &mut [W::One],
        largest: &mut Lanes,
        record: &mut impl StepRecord,
    ) {
        let (start, end) = (strip.start, strip.end);
        let row = &mut row[..end + STRIP];
        let mut cells = W::NONE;
        let mut diagonal = match strip.corner {
            Some(lane) => W::origin(lane),
            None => W::NONE.below(row[start + STRIP - 2]),
        };
        let mut t_max = *largest;
        let mut y = self.window(start);
        let mut next = start;
        while next <= end {
            let stop = end.min(next | (STRETCH - 1));
            for d in next..=stop {
                if d > start {
                    y = [self.column(d, 0), y[0], y[1], y[2]];
                }
                let mut t = [0.0; STRIP];
                for l in 0..STRIP {
                    t[l] = metric.between(&strip.x[l], &y[l]) * scale;
                }
                let up = cells.below(row[d + STRIP - 1]);
                let (reached, (addends, sums)) = W::cells(&diagonal, &up, &cells, &t);
                cells = reached;
                if BANDED {
                    let step = d as f64;
                    let mut inside = [false; STRIP];
                    for l in 0..STRIP {
                        inside[l] = strip.first[l] <= step && step <= strip.last[l];
                        t[l] = if inside[l] { t[l] } else { 0.0 };
                    }
                    cells = cells.within(inside);
                }
                for (t_max, t) in t_max.iter_mut().zip(t) {
                    *t_max = if t > *t_max { t } else { *t_max };
                }
                record.step(&addends, &sums);
                diagonal = up;
                row[d] = cells.last();
            }
            // The diagonal of the next step may stay as it is: the step after that takes its own from these.
            cells = cells.normalised();
            next = stop + 1;
        }
        *largest = t_max;
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::{EXACT, Forget, PLAIN, SHORT};
    use crate::band::Band;
    use crate::cost::Cost;
    use crate::exp2::Lanes;
    use crate::grid::Grid;
    use crate::weight::{Plain, Scaled, Weight};

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

        #[test]
        fn both_kinds_of_weight_give_the_same_bits(
            x in prop::collection::vec(prop::array::uniform2(-1.0..1.0_f64), 1..26),
            y in prop::collection::vec(prop::array::uniform2(-1.0..1.0_f64), 1..26),
            scale in -3.0..2.0_f64, radius in prop::option::of(0..9_usize),
        ) {
            let band = radius.map(Band::new);
            let grid = Grid { rows: &x, columns: &y, gamma: 1.0, cost: Cost::SquaredEuclidean, band };
            let path = (x.len() + y.len()) as f64;
            let scale = 10.0_f64.powf(scale);
            let plain = grid.run::<Plain>(scale, PLAIN / path, &mut [Plain::NONE_ONE; SHORT], &mut Forget);
            let mut row = [Scaled::NONE_ONE; SHORT];
            let scaled = grid.run::<Scaled<Lanes>>(scale, EXACT / path, &mut row, &mut Forget);
            let (significand, exponent) = scaled.expect("costs far below the limit");
            prop_assert!((1.0..2.0).contains(&significand));
            // The largest squared distance is 8: only where the plain kind cannot hold R it may refuse.
            prop_assert!(plain.is_some() || 8.0 * scale * path > PLAIN);
            if let Some(plain) = plain {
                prop_assert_eq!(plain, (significand, exponent));
            }
        }
    }
}
