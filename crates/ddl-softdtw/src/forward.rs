//! The recursion of soft-DTW in the exponential domain, eight rows at a time along antidiagonals.
//!
//! With R(i, j) = exp(−r(i, j)/γ) the smoothed minimum is a sum,
//!
//! ```text
//! R(i, j) = 2^−t(i, j) · ( R(i−1, j−1) + R(i−1, j) + R(i, j−1) ),   t = δ log2(e) / γ,
//! ```
//!
//! so a cell needs one exponential and no logarithm. R is held as `significand · 2^exponent`, the exponent an exact
//! integer: nothing cancels and nothing underflows.
//!
//! # Error
//! To first order in u = 2^−53, the relative error of R is at most the largest error of a path, the sum of the errors
//! of its cells.
//! A cell contributes (D + 5) u t ln 2 for t (D components), 2.8 u for 2^−t, and 3 u for the two sums and the product.
//! A path has at most n + m − 1 cells. The mean cost of the paths, weighted by exp(−cost/γ), exceeds the value by γ
//! times their entropy, at most γ ln(paths) < 0.9 γ (n + m). The logarithm and the last two products add 5 u |v| + 3 u
//! γ. The total is less than (D + 12) u (|v| + γ (n + m)).
//!
//! # Order
//! Eight consecutive rows (a strip) advance together, each one column behind the row above it: the cells of a step are
//! independent of each other. One row is kept between strips.
#![expect(clippy::inline_always, reason = "the lanes must stay in registers")]

use crate::exp2::exp2_parts;
use crate::grid::{Grid, STRIP, Slanted, Strip};
use crate::weight::{Cells, NONE, Weight, below, lane, normalised, normalised_one, only, splat, sums};
use ddl_simd::{Dispatch, Kernel, Simd};

/// Entries of the working memory that fit on the stack.
const SHORT: usize = 48;
/// Number of columns and rows after which significands are normalised to [1, 2). Between two normalisations a path has
/// at most 2 · 128 cells, one per antidiagonal. Each cell multiplies the significand by 2^−1/2 to (1 + √2) √2 < 2^1.78.
/// The total factor is 2^−128 to 2^456, which leaves room for addends that are 2^700 smaller.
pub(crate) const STRETCH: usize = 128;

/// What the backward recursion needs of a step of a strip.
#[derive(Clone, Copy)]
pub(crate) struct ForwardStep<S: Simd> {
    /// 2^−t of each cell.
    pub(crate) factor: Cells<S>,
    /// R of each cell.
    pub(crate) cells: Cells<S>,
}

impl<const D: usize> Grid<'_, D> {
    /// The soft-DTW value; infinite when it exceeds the range of `f64`.
    pub(crate) fn value(&self) -> f64 {
        self.value_with(Dispatch::detect())
    }

    /// The value. It has the same bits for every instruction set, because the same products are fused everywhere.
    fn value_with(&self, dispatch: Dispatch) -> f64 {
        if !self.is_exact() {
            return self.log_domain_value();
        }
        let mut value = 0.0;
        dispatch.run(Forward(self, &mut value));
        value
    }

    /// −γ ln R.
    pub(crate) fn value_of(&self, [significand, exponent]: Weight) -> f64 {
        -self.gamma * (exponent * std::f64::consts::LN_2 + significand.ln())
    }

    /// R of the last cell, with a significand in [1, 2). `steps` receives all steps if `RECORD`.
    #[inline(always)]
    pub(crate) fn forward<S: Simd, const RECORD: bool>(
        &self,
        simd: S,
        columns: &Slanted<D>,
        steps: &mut Vec<ForwardStep<S>>,
    ) -> Weight {
        // Entry c + 7 is column c. A step reads entry d + 7 (column d) for its first lane and writes entry d (column d
        // − 7) from its last; seven additional entries before and after the columns serve the slanted ends of a strip.
        let (mut short, mut long) = ([NONE; SHORT], Vec::new());
        let length = self.columns.len() + 2 * (STRIP - 1);
        let row = if length <= SHORT {
            &mut short[..length]
        } else {
            long.resize(length, NONE);
            &mut long
        };
        for index in 0..self.strips() {
            let strip = self.strip(index);
            let before = steps.len();
            if RECORD {
                let none = splat(simd, NONE);
                let (factor, cells) = (none, none);
                steps.resize(before + strip.end + 1 - strip.start, ForwardStep { factor, cells });
            }
            self.advance::<S, RECORD>(simd, &strip, columns, row, &mut steps[before..]);
            if (index + 1) % (STRETCH / STRIP) == 0 {
                for cell in &mut *row {
                    *cell = normalised_one(*cell);
                }
            }
        }
        normalised_one(row[self.columns.len() + STRIP - 2])
    }

    /// Computes one strip. Before the call `row` holds the row above the strip, after it the last row of the strip.
    #[inline(always)]
    fn advance<S: Simd, const RECORD: bool>(
        &self,
        simd: S,
        strip: &Strip<D>,
        columns: &Slanted<D>,
        row: &mut [Weight],
        steps: &mut [ForwardStep<S>],
    ) {
        let (start, end) = (strip.start, strip.end);
        let row = &mut row[..end + STRIP];
        let minus_scale = -self.scale();
        let none = splat(simd, NONE);
        let mut cells = none;
        let mut diagonal = match strip.corner {
            Some(first) => only(simd, first),
            None => below(simd, none, row[start + STRIP - 2]),
        };
        let mut next = start;
        while next <= end {
            let stop = end.min(next | (STRETCH - 1));
            for d in next..=stop {
                let differences = columns.differences(simd, &strip.x, d);
                let factor = exp2_parts(simd, Self::costs(simd, differences) * minus_scale);
                let up = below(simd, cells, row[d + STRIP - 1]);
                [_, cells] = sums([diagonal, up, cells], factor);
                if RECORD {
                    steps[d - start] = ForwardStep { factor, cells };
                }
                diagonal = up;
                row[d] = lane(cells, STRIP - 1);
            }
            // `diagonal` need not be normalised, because only the next step uses it.
            cells = normalised(cells);
            next = stop + 1;
        }
    }
}

struct Forward<'a, 'b, const D: usize>(&'a Grid<'b, D>, &'a mut f64);

impl<const D: usize> Kernel for Forward<'_, '_, D> {
    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let Self(grid, value) = self;
        let columns = Slanted::of(grid.columns);
        *value = grid.value_of(grid.forward::<S, false>(simd, &columns, &mut Vec::new()));
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use ddl_simd::{Dispatch, InstructionSet};

    use crate::grid::Grid;

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

        #[test]
        fn every_instruction_set_gives_the_same_bits(
            x in prop::collection::vec(prop::array::uniform3(-3.0..3.0_f64), 1..40),
            y in prop::collection::vec(prop::array::uniform3(-3.0..3.0_f64), 1..40),
            gamma in 0.01..10.0_f64,
        ) {
            let grid = Grid { rows: &x, columns: &y, gamma };
            let results = |set| {
                let dispatch = Dispatch::new(set).expect("available");
                (grid.value_with(dispatch), grid.value_and_gradient_with(dispatch))
            };
            let portable = results(InstructionSet::Portable);
            prop_assert_eq!(portable.0.to_bits(), portable.1.0.to_bits());
            for set in InstructionSet::available() {
                prop_assert_eq!(&results(set), &portable);
            }
        }
    }
}
