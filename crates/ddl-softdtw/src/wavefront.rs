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
#![expect(
    clippy::inline_always,
    reason = "the lanes stay in registers only when what works on them is inlined"
)]

use ddl_simd::{Dispatch, Register, RegisterKernel};

use crate::cost::{Cost, Length, Metric, Squared};
use crate::grid::{Grid, Slanted, Strip};
use crate::lanes::{Lanes, STRIP};
use crate::scalar::Scalar;
use crate::weight::{Plain, Scaled, Weight};

/// Exponents are exact integers while the whole parts of all t along a path sum to no more than this.
const EXACT: f64 = 4_503_599_627_370_496.0; // 2^52
/// Entries of the working memory that fit on the stack.
const SHORT: usize = 48;
/// Number of columns and rows after which significands are normalised to [1, 2). Between two normalisations a path has
/// at most 2 · 128 cells, one per antidiagonal. Each cell multiplies the significand by 2^−1/2 to (1 + √2) √2 < 2^1.78.
/// The total factor is 2^−128 to 2^456, which leaves room for addends that are 2^700 smaller.
pub(crate) const STRETCH: usize = 128;

/// What the backward recursion needs of each step of each strip. The room is made strip by strip, because a call in
/// every step would force the registers into memory.
pub(crate) trait StepRecord<W: Weight> {
    type Step;

    /// Room for the next strip of `steps` steps.
    fn strip(&mut self, steps: usize) -> &mut [Self::Step];

    /// 2^−t and R of each cell of a step.
    fn step(factor: &W::Factor, cells: &W) -> Self::Step;
}

/// Records nothing.
#[derive(Default)]
struct Forget(Vec<()>);

impl<W: Weight> StepRecord<W> for Forget {
    type Step = ();

    #[inline(always)]
    fn strip(&mut self, steps: usize) -> &mut [()] {
        self.0.resize(steps, ());
        &mut self.0
    }

    #[inline(always)]
    fn step(_: &W::Factor, _: &W) {}
}

/// Compiled for each instruction set: the loops over lanes become vectors of its width. All give the same bits, because
/// the same products are fused everywhere.
struct Forwards<'a, 'b, T, const D: usize>(&'a Grid<'b, T, D>);

impl<T: Scalar, const D: usize> RegisterKernel for Forwards<'_, '_, T, D> {
    type Output = Option<f64>;

    #[inline(always)]
    fn run<S: Register>(self, simd: S) -> Option<f64> {
        let columns = Slanted::of(self.0.columns);
        let total = match self.0.plain_start() {
            Some(start) => self.0.run::<S, Plain>(simd, start, &columns, &mut Forget::default()),
            None => self
                .0
                .run::<S, Scaled<Lanes>>(simd, 0.0, &columns, &mut Forget::default()),
        };
        total.map(|total| self.0.value_of(total))
    }
}

impl<T: Scalar, const D: usize> Grid<'_, T, D> {
    /// The soft-DTW value, or `None` if costs are so large relative to γ that the log domain must be used.
    pub(crate) fn value(&self) -> Option<f64> {
        Dispatch::detect().run_on_registers(Forwards(self))
    }

    /// −γ ln R.
    pub(crate) fn value_of(&self, (significand, exponent): (f64, f64)) -> f64 {
        -self.gamma * (exponent * std::f64::consts::LN_2 + significand.ln())
    }

    /// R of the last cell as significand and exponent, computed from R(0, 0) = 2^`start`. `None` when some t is too
    /// large.
    #[inline(always)]
    pub(crate) fn run<S: Register, W: Weight>(
        &self,
        simd: S,
        start: f64,
        columns: &Slanted<D>,
        record: &mut impl StepRecord<W>,
    ) -> Option<(f64, f64)> {
        let scale = self.scale();
        if !scale.is_finite() {
            return None;
        }
        let path = (self.rows.len() + self.columns.len()) as f64;
        // Entry c + 7 is column c. A step reads entry d + 7 (column d) for its first lane and writes entry d (column d
        // − 7) from its last; seven additional entries before and after the columns serve the slanted ends of a strip.
        let mut short = [W::NONE_ONE; SHORT];
        let mut long = Vec::new();
        let length = self.columns.len() + 2 * (STRIP - 1);
        let row = row_of(&mut short, &mut long, length, W::NONE_ONE);
        let mut lowest = [0.0; STRIP];
        for index in 0..self.strips() {
            let strip = self.strip(index);
            let (lowest, start) = (&mut lowest, W::power(start));
            match (self.cost, self.band) {
                (Cost::SquaredEuclidean, None) => {
                    advance::<S, W, _, _, D, false>(
                        simd,
                        Squared,
                        &strip,
                        (scale, columns, start),
                        row,
                        lowest,
                        record,
                    );
                }
                (Cost::SquaredEuclidean, Some(_)) => {
                    advance::<S, W, _, _, D, true>(simd, Squared, &strip, (scale, columns, start), row, lowest, record);
                }
                (Cost::Euclidean, None) => {
                    advance::<S, W, _, _, D, false>(simd, Length, &strip, (scale, columns, start), row, lowest, record);
                }
                (Cost::Euclidean, Some(_)) => {
                    advance::<S, W, _, _, D, true>(simd, Length, &strip, (scale, columns, start), row, lowest, record);
                }
            }
            if lowest.iter().any(|&minus_t| minus_t < -EXACT / path) {
                return None;
            }
            if (index + 1) % (STRETCH / STRIP) == 0 {
                for cell in &mut *row {
                    *cell = W::normalised_one(*cell);
                }
            }
        }
        let (significand, exponent) = W::parts(row[self.columns.len() + STRIP - 2]);
        Some((significand, exponent - start))
    }
}

/// Computes one strip. Before the call `row` holds the row above the strip, after it the last row of the strip.
/// `lowest` receives the smallest −t of each lane.
#[inline(always)]
fn advance<S: Register, W: Weight, R: StepRecord<W>, M: Metric, const D: usize, const BANDED: bool>(
    simd: S,
    metric: M,
    strip: &Strip<D>,
    (scale, columns, one): (f64, &Slanted<D>, W::One),
    row: &mut [W::One],
    lowest: &mut Lanes,
    record: &mut R,
) {
    let (start, end) = (strip.start, strip.end);
    let steps = record.strip(end + 1 - start);
    let row = &mut row[..end + STRIP];
    let mut cells = W::NONE;
    let mut diagonal = match strip.corner {
        Some(lane) => W::alone(lane, one),
        None => W::NONE.below(simd, row[start + STRIP - 2]),
    };
    let mut smallest = *lowest;
    let mut next = start;
    while next <= end {
        let stop = end.min(next | (STRETCH - 1));
        for d in next..=stop {
            let mut minus_t = metric.of_lanes(simd, &strip.x, columns.window(d));
            for part in 0..S::PARTS {
                let scaled = simd.wide_mul(simd.wide_load(&minus_t, part), simd.wide_splat(-scale));
                simd.wide_store(scaled, &mut minus_t, part);
            }
            let mut inside = None;
            if BANDED {
                let step = d as f64;
                let inside = inside.insert([true; STRIP]);
                for l in 0..STRIP {
                    inside[l] = strip.first[l] <= step && step <= strip.last[l];
                    minus_t[l] = if inside[l] { minus_t[l] } else { 0.0 };
                }
            }
            if W::UNBOUNDED {
                for part in 0..S::PARTS {
                    let (minus_t, before) = (simd.wide_load(&minus_t, part), simd.wide_load(&smallest, part));
                    simd.wide_store(simd.wide_min(minus_t, before), &mut smallest, part);
                }
            }
            let factor = W::factor(simd, &minus_t, inside.as_ref());
            let up = cells.below(simd, row[d + STRIP - 1]);
            (_, cells) = W::cells(simd, [&diagonal, &up, &cells], &factor);
            steps[d - start] = R::step(&factor, &cells);
            diagonal = up;
            row[d] = cells.last();
        }
        // `diagonal` need not be normalised, because only the next step uses it.
        cells = cells.normalised();
        next = stop + 1;
    }
    *lowest = smallest;
}

/// Working memory of `length` entries, on the stack if it fits there.
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
    use std::marker::PhantomData;

    use proptest::prelude::*;

    use ddl_simd::{Dispatch, InstructionSet, Register, RegisterKernel};

    use super::{Forget, Forwards};
    use crate::alignment::Backwards;
    use crate::band::Band;
    use crate::cost::Cost;
    use crate::grid::{Grid, Slanted};
    use crate::lanes::Lanes;
    use crate::weight::{Plain, Scaled, Weight};

    /// The recursion with one kind of weight, from 2^start.
    struct Run<'a, W>((&'a Grid<'a, f64, 2>, &'a Slanted<2>), f64, PhantomData<W>);

    impl<W: Weight> RegisterKernel for Run<'_, W> {
        type Output = Option<(f64, f64)>;

        fn run<S: Register>(self, simd: S) -> Self::Output {
            let Self((grid, columns), start, _) = self;
            grid.run::<S, W>(simd, start, columns, &mut Forget::default())
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

        #[test]
        fn both_kinds_of_weight_give_the_same_bits(
            x in prop::collection::vec(prop::array::uniform2(-1.0..1.0_f64), 1..70),
            y in prop::collection::vec(prop::array::uniform2(-1.0..1.0_f64), 1..70),
            gamma in -2.7..3.0_f64, radius in prop::option::of(0..9_usize),
        ) {
            let gamma = 10.0_f64.powf(gamma);
            let band = radius.map(Band::new);
            let (rows, columns) = if x.len() < y.len() { (&y, &x) } else { (&x, &y) };
            let grid = Grid { rows, columns, gamma, cost: Cost::SquaredEuclidean, band };
            let columns = Slanted::of(grid.columns);
            let dispatch = Dispatch::detect();
            let of_grid = (&grid, &columns);
            let scaled = dispatch.run_on_registers(Run::<Scaled<Lanes>>(of_grid, 0.0, PhantomData));
            let (significand, _) = scaled.expect("costs far below the limit");
            prop_assert!((1.0..2.0).contains(&significand));
            // The largest squared distance is 8.
            let start = grid.plain_start();
            prop_assert!(start.is_some() || 8.0 * grid.scale() * rows.len() as f64 > 1000.0);
            if let Some(start) = start {
                let plain = dispatch.run_on_registers(Run::<Plain>(of_grid, start, PhantomData));
                prop_assert_eq!(plain, scaled);
            }
        }

        #[test]
        fn every_instruction_set_gives_the_same_bits(
            x in prop::collection::vec(prop::array::uniform3(-3.0..3.0_f64), 1..40),
            y in prop::collection::vec(prop::array::uniform3(-3.0..3.0_f64), 1..40),
            gamma in 0.01..10.0_f64, squared in any::<bool>(),
        ) {
            let cost = if squared { Cost::SquaredEuclidean } else { Cost::Euclidean };
            let (rows, columns) = if x.len() < y.len() { (&y, &x) } else { (&x, &y) };
            let grid = Grid { rows, columns, gamma, cost, band: None };
            let results = |set| {
                let dispatch = Dispatch::new(set).expect("available");
                (dispatch.run_on_registers(Forwards(&grid)), dispatch.run_on_registers(Backwards(&grid)))
            };
            let portable = results(InstructionSet::Portable);
            for set in InstructionSet::available() {
                prop_assert_eq!(&results(set), &portable);
            }
        }
    }
}
