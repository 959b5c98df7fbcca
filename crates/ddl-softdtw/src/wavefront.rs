//! The recursion of soft-DTW in the exponential domain, eight rows at a time along antidiagonals.
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
//! To first order in u = 2^−53, the relative error of R is at most the largest over paths of the sum of those of its
//! cells:
//! (D + 5) u t ln 2 for t itself (D components), 2.1 u for 2^−t, 3 u for the two sums and the product. At most n + m −
//! 1
//! cells make a path, and the mean of the cost over paths, weighted by exp(−cost/γ), exceeds the value by γ times their
//! entropy, at most γ ln(paths) < 0.9 γ (n + m). The logarithm and the last two products add 5 u |v| + 3 u γ. In all
//! less than (D + 12) u (|v| + γ (n + m)).
//!
//! # Order
//! Eight consecutive rows (a strip) advance together, each one column behind the row above it: the cells of a step are
//! independent of each other. One row is kept between strips.
#![expect(
    clippy::inline_always,
    reason = "the lanes stay in registers only when what works on them is inlined"
)]

use ddl_simd::{Dispatch, Register, RegisterKernel};

use crate::cost::{Cost, Length, Metric, Squared};
use crate::exp2::{Lanes, STRIP};
use crate::grid::{Grid, Slanted, Strip};
use crate::scalar::Scalar;
use crate::weight::{Plain, Scaled, Weight};

/// Exponents are exact integers while the whole parts of all t along a path sum to no more than this.
const EXACT: f64 = 4_503_599_627_370_496.0; // 2^52
/// Plain numbers suffice while all t along a path sum to no more than this, and the path has at most so many cells: R
/// is then from
/// 2^−700 to 3^600 = 2^951.
const PLAIN: f64 = 700.0;
const LONGEST_PLAIN: f64 = 600.0;
/// Entries of the working memory that fit on the stack.
const SHORT: usize = 48;
/// Significands are brought back to [1, 2) every so many columns and rows. Between two of these a path has at most 2 ·
/// 128
/// cells, an antidiagonal each, and each multiplies the significand by 2^−1/2 to (1 + √2) √2 < 2^1.78: in all by
/// 2^−128 to 2^456, which leaves room for addends that are 2^700 smaller.
const STRETCH: usize = 128;

/// Receives what the backward recursion needs of each step of each strip.
pub(crate) trait StepRecord {
    /// The addends of each cell, from (i−1, j−1), (i−1, j) and (i, j−1), and their sums.
    fn step(&mut self, addends: &[Lanes; 3], sums: &Lanes);
}

pub(crate) struct Forget;

impl StepRecord for Forget {
    #[inline(always)]
    fn step(&mut self, _: &[Lanes; 3], _: &Lanes) {}
}

/// Compiled for each instruction set: the loops over lanes become vectors of its width. Every operation is rounded by
/// itself, so that all
/// give the same bits.
struct Forwards<'a, 'b, T, const D: usize, R> {
    grid: &'a Grid<'b, T, D>,
    record: &'a mut R,
}

impl<T: Scalar, const D: usize, R: StepRecord> RegisterKernel for Forwards<'_, '_, T, D, R> {
    type Output = Option<f64>;

    #[inline(always)]
    fn run<S: Register>(self, _: S) -> Option<f64> {
        let columns = Slanted::of(self.grid.columns);
        self.grid.value_here(&columns, self.record)
    }
}

impl<T: Scalar, const D: usize> Grid<'_, T, D> {
    /// The soft-DTW value, or `None` where costs are so large against γ that the log domain must be used.
    pub(crate) fn value(&self, record: &mut impl StepRecord) -> Option<f64> {
        let forwards = Forwards { grid: self, record };
        Dispatch::detect().run_on_registers(forwards)
    }

    #[inline(always)]
    pub(crate) fn value_here(
        &self,
        columns: &Slanted,
        record: &mut impl StepRecord,
    ) -> Option<f64> {
        let scale = std::f64::consts::LOG2_E / self.gamma;
        if !scale.is_finite() {
            return None;
        }
        // Entry c + 7 is column c. A step reads entry d + 7 (column d) for its first lane and writes entry d (column d
        // − 7)
        // from its last; seven entries before and after the columns take what the slanted ends of a strip read and
        // write.
        let length = self.columns.len() + 2 * (STRIP - 1);
        let path = (self.rows.len() + self.columns.len()) as f64;
        let bound = self.cost_bound() * scale;
        let end = if path <= LONGEST_PLAIN && bound * path <= PLAIN {
            let mut short = [Plain::NONE_ONE; SHORT];
            let mut long = Vec::new();
            let row = row_of(&mut short, &mut long, length, Plain::NONE_ONE);
            self.run::<Plain>(scale, f64::INFINITY, columns, row, record)
        } else {
            let mut short = [Scaled::NONE_ONE; SHORT];
            let mut long = Vec::new();
            let row = row_of(&mut short, &mut long, length, Scaled::NONE_ONE);
            self.run::<Scaled<Lanes>>(scale, EXACT / path, columns, row, record)
        };
        let (significand, exponent) = end?;
        Some(-self.gamma * (exponent * std::f64::consts::LN_2 + significand.ln()))
    }

    /// R of the last cell as significand and exponent, or `None` when some t exceeds `limit`.
    #[inline(always)]
    fn run<W: Weight>(
        &self,
        scale: f64,
        limit: f64,
        columns: &Slanted,
        row: &mut [W::One],
        record: &mut impl StepRecord,
    ) -> Option<(f64, f64)> {
        let mut largest = [0.0; STRIP];
        for index in 0..self.strips() {
            let strip = self.strip(index);
            let t_max = &mut largest;
            match (self.cost, self.band) {
                (Cost::SquaredEuclidean, None) => {
                    advance::<W, _, D, false>(
                        Squared,
                        &strip,
                        (scale, columns),
                        row,
                        t_max,
                        record,
                    );
                }
                (Cost::SquaredEuclidean, Some(_)) => {
                    advance::<W, _, D, true>(Squared, &strip, (scale, columns), row, t_max, record);
                }
                (Cost::Euclidean, None) => {
                    advance::<W, _, D, false>(Length, &strip, (scale, columns), row, t_max, record);
                }
                (Cost::Euclidean, Some(_)) => {
                    advance::<W, _, D, true>(Length, &strip, (scale, columns), row, t_max, record);
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
}

/// One strip: `row` holds the row above it before, its last row after. `largest` takes the largest t of each lane.
#[inline(always)]
fn advance<W: Weight, M: Metric, const D: usize, const BANDED: bool>(
    metric: M,
    strip: &Strip<D>,
    (scale, columns): (f64, &Slanted),
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
    let mut next = start;
    while next <= end {
        let stop = end.min(next | (STRETCH - 1));
        for d in next..=stop {
            let mut t = metric.of_lanes(&strip.x, &columns.window(d));
            for t in &mut t {
                *t *= scale;
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

/// The working memory of so many entries: on the stack where it fits there.
#[inline(always)]
fn row_of<'a, One: Copy>(
    short: &'a mut [One; SHORT],
    long: &'a mut Vec<One>,
    length: usize,
    none: One,
) -> &'a mut [One] {
    if length <= SHORT {
        &mut short[..length]
    } else {
        long.resize(length, none);
        long
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use ddl_simd::{Dispatch, InstructionSet};

    use super::{EXACT, Forget, Forwards, PLAIN, SHORT};
    use crate::band::Band;
    use crate::cost::Cost;
    use crate::exp2::Lanes;
    use crate::grid::{Grid, Slanted};
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
            let columns = Slanted::of(grid.columns);
            let mut row = [Plain::NONE_ONE; SHORT];
            let plain = grid.run::<Plain>(scale, PLAIN / path, &columns, &mut row, &mut Forget);
            let mut row = [Scaled::NONE_ONE; SHORT];
            let scaled = grid.run::<Scaled<Lanes>>(scale, EXACT / path, &columns, &mut row, &mut Forget);
            let (significand, exponent) = scaled.expect("costs far below the limit");
            prop_assert!((1.0..2.0).contains(&significand));
            // The largest squared distance is 8: only where the plain kind cannot hold R it may refuse.
            prop_assert!(plain.is_some() || 8.0 * scale * path > PLAIN);
            if let Some(plain) = plain {
                prop_assert_eq!(plain, (significand, exponent));
            }
        }

        #[test]
        fn every_instruction_set_gives_the_same_bits(
            x in prop::collection::vec(prop::array::uniform3(-3.0..3.0_f64), 1..40),
            y in prop::collection::vec(prop::array::uniform3(-3.0..3.0_f64), 1..40),
            gamma in 0.01..10.0_f64, squared in any::<bool>(),
        ) {
            let cost = if squared { Cost::SquaredEuclidean } else { Cost::Euclidean };
            let grid = Grid { rows: &x, columns: &y, gamma, cost, band: None };
            let value = |set| {
                let record = &mut Forget;
                let forwards = Forwards { grid: &grid, record };
                Dispatch::new(set).map(|dispatch| dispatch.run_on_registers(forwards))
            };
            let portable = value(InstructionSet::Portable);
            for set in InstructionSet::available() {
                prop_assert_eq!(value(set), portable);
            }
        }
    }
}
