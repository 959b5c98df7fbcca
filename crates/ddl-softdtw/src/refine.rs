//! Values of many pairs in `f64`, eight at a time in the exponential domain. The value of a pair does not depend on its
//! neighbours, the instruction set or the number of threads: every operation is rounded separately, in a fixed order.

#![expect(clippy::inline_always, reason = "the lanes must stay in registers")]

use ddl_simd::{Dispatch, Register, RegisterKernel, WIDE_LANES, wide_exp2_each};

use crate::cost::Cost;
use crate::range::{Range, WIDE_FLOOR};
use crate::value::SoftDtw;

/// Range of γ. Outside of it, the squares of differences may leave the range of `f64` although their cost does not.
const GAMMAS: std::ops::RangeInclusive<f64> = 1e-100..=1e100;

/// Number of cells whose similarities are computed together, to hide the latency of the operations.
const WIDE_GROUP: usize = 4;

pub(crate) type WideLanes = [f64; WIDE_LANES];

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum PairValue {
    Known(f64),
    /// A lower bound: the value is too large for the range of the recursion.
    AtLeast(f64),
}

/// Evaluates pairs of sequences in blocks of eight. The error of a known value is at most γ ln 2 times
/// [`wide_error_log2`](crate::range::wide_error_log2): 4e-14 γ for eight steps and values near 0.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PairValues {
    dtw: SoftDtw,
    dispatch: Dispatch,
}

type Both<'a, const D: usize> = (&'a [[f64; D]], &'a [[f64; D]]);
/// A pair that waits for its block: its index in the result, and both sequences.
type Pair<'a, const D: usize> = (usize, &'a [[f64; D]], &'a [[f64; D]]);

impl PairValues {
    pub(crate) fn new(dtw: SoftDtw, dispatch: Dispatch) -> Self {
        Self { dtw, dispatch }
    }

    pub(crate) fn of<'a, const D: usize>(&self, pairs: impl Iterator<Item = Both<'a, D>>) -> Vec<PairValue> {
        let mut pairs: Vec<Pair<'a, D>> = pairs.enumerate().map(|(i, (x, y))| (i, x, y)).collect();
        let mut values = vec![PairValue::AtLeast(f64::NEG_INFINITY); pairs.len()];
        if !GAMMAS.contains(&self.dtw.gamma()) || self.dtw.band().is_some() {
            return values;
        }
        let lengths = |pair: &Pair<'a, D>| (pair.1.len(), pair.2.len());
        if !pairs.is_sorted_by_key(lengths) {
            pairs.sort_by_key(lengths);
        }
        let mut working = WideWorking::default();
        for same in pairs.chunk_by(|a, b| lengths(a) == lengths(b)) {
            let (n, m) = lengths(&same[0]);
            let Some(range) = Range::wide(n, m) else {
                continue;
            };
            for block in same.chunks(WIDE_LANES) {
                let sums = self.block(range, block, &mut working);
                for (&(place, ..), sum) in block.iter().zip(sums) {
                    values[place] = self.value(range, sum);
                }
            }
        }
        values
    }

    /// `D_γ` of every pair of checked sequences; pairs beyond the range of the exponential domain use the log domain.
    pub(crate) fn all<const D: usize>(&self, pairs: &[Both<'_, D>]) -> Vec<f64> {
        let known = self.of(pairs.iter().copied());
        let value = |(pair, known): (&Both<'_, D>, _)| match known {
            PairValue::Known(value) => value,
            PairValue::AtLeast(_) => self.beyond(pair.0, pair.1),
        };
        pairs.iter().zip(known).map(value).collect()
    }

    pub(crate) fn beyond<const D: usize>(&self, x: &[[f64; D]], y: &[[f64; D]]) -> f64 {
        self.dtw.value_unchecked(x, y)
    }

    /// Sums over the warping paths of up to eight pairs of equal lengths, start value included.
    fn block<const D: usize>(&self, range: Range, pairs: &[Pair<'_, D>], working: &mut WideWorking<D>) -> WideLanes {
        let (_, x, y) = pairs[0];
        working.x.resize(x.len(), [[0.0; WIDE_LANES]; D]);
        working.y.resize(y.len(), [[0.0; WIDE_LANES]; D]);
        working.row.resize(y.len(), [0.0; WIDE_LANES]);
        for lane in 0..WIDE_LANES {
            // Free lanes repeat the last pair, so that they are not slower or out of range.
            let (_, x, y) = pairs[lane.min(pairs.len() - 1)];
            spread(x, lane, &mut working.x);
            spread(y, lane, &mut working.y);
        }
        self.dispatch.run_on_registers(WideRecursion {
            x: &working.x,
            y: &working.y,
            row: &mut working.row,
            start: f64::from(range.start_log2()).exp2(),
            scale: -std::f64::consts::LOG2_E / self.dtw.gamma(),
            cost: self.dtw.cost(),
        })
    }

    fn value(&self, range: Range, sum: f64) -> PairValue {
        let gamma = self.dtw.gamma();
        let start = f64::from(range.start_log2());
        let smallest = range.smallest_accurate_log2();
        if sum >= smallest.exp2() {
            // Dividing by a power of two is exact, so the start value costs the logarithm no digits.
            PairValue::Known(-gamma * (sum * (-start).exp2()).ln())
        } else {
            // Clamp and floor can only increase the sum; one unit covers its rounding.
            let reach = (start - smallest) * std::f64::consts::LN_2 - 1.0;
            PairValue::AtLeast(gamma * reach)
        }
    }
}

fn spread<const D: usize>(steps: &[[f64; D]], lane: usize, into: &mut [[WideLanes; D]]) {
    for (step, into) in steps.iter().zip(into) {
        for (value, lanes) in step.iter().zip(into) {
            lanes[lane] = *value;
        }
    }
}

struct WideWorking<const D: usize> {
    x: Vec<[WideLanes; D]>,
    y: Vec<[WideLanes; D]>,
    row: Vec<WideLanes>,
}

impl<const D: usize> Default for WideWorking<D> {
    fn default() -> Self {
        Self {
            x: Vec::new(),
            y: Vec::new(),
            row: Vec::new(),
        }
    }
}

/// The recursion of [`crate::recursion`] in `f64`, on eight pairs.
struct WideRecursion<'a, const D: usize> {
    x: &'a [[WideLanes; D]],
    y: &'a [[WideLanes; D]],
    row: &'a mut [WideLanes],
    start: f64,
    scale: f64,
    cost: Cost,
}

impl<const D: usize> RegisterKernel for WideRecursion<'_, D> {
    type Output = WideLanes;

    #[inline(always)]
    fn run<S: Register>(self, simd: S) -> WideLanes {
        let (zero, scale) = (simd.wide_splat(0.0), simd.wide_splat(self.scale));
        let floor = simd.wide_splat(WIDE_FLOOR);
        let mut sums = [0.0; WIDE_LANES];
        for part in 0..S::PARTS {
            self.row.fill([0.0; WIDE_LANES]);
            let mut corner = simd.wide_splat(self.start);
            let mut left = zero;
            for x in self.x {
                let mut diagonal = corner;
                left = zero;
                for (row, y) in self.row.chunks_mut(WIDE_GROUP).zip(self.y.chunks(WIDE_GROUP)) {
                    let mut exponents = [zero; WIDE_GROUP];
                    for (exponent, y) in exponents.iter_mut().zip(y) {
                        let mut cost = zero;
                        for d in 0..D {
                            let x = simd.wide_load(&x[d], part);
                            let difference = simd.wide_sub(x, simd.wide_load(&y[d], part));
                            cost = simd.wide_add(cost, simd.wide_mul(difference, difference));
                        }
                        if self.cost == Cost::Euclidean {
                            cost = simd.wide_sqrt(cost);
                        }
                        *exponent = simd.wide_mul(cost, scale);
                    }
                    let ks = wide_exp2_each(simd, exponents);
                    for (cell, k) in row.iter_mut().zip(ks) {
                        let up = simd.wide_load(cell, part);
                        let others = simd.wide_add(simd.wide_add(diagonal, up), floor);
                        left = simd.wide_mul(k, simd.wide_add(others, left));
                        simd.wide_store(left, cell, part);
                        diagonal = up;
                    }
                }
                corner = zero;
            }
            simd.wide_store(left, &mut sums, part);
        }
        sums
    }
}

#[cfg(test)]
mod tests;
