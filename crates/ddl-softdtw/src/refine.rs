//! Values of many pairs in `f64`, eight at a time in the exponential domain. The value of a pair does not depend on its
//! neighbours, the instruction set or the number of threads: every operation is rounded in the same way, in a fixed
//! order.

#![expect(clippy::inline_always, reason = "the lanes must stay in registers")]

use ddl_simd::{Dispatch, Kernel, Simd};
use fearless_simd::f64x8;
use fearless_simd::prelude::*;

use crate::cost::Cost;
use crate::exp2::{exp2_parts, times_power};
use crate::grid::{Lanes, STRIP};
use crate::range::{COST_LIMIT_64, FLOOR_64, Range};
use crate::value::SoftDtw;

/// Range of γ. Outside of it, the squares of differences may leave the range of `f64` although their cost does not.
const GAMMAS: std::ops::RangeInclusive<f64> = 1e-100..=1e100;

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum PairValue {
    Known(f64),
    /// A lower bound: the value is too large for the range of the recursion.
    AtLeast(f64),
}

/// Evaluates pairs of sequences in blocks of eight. The error of a known value is at most γ ln 2 times
/// [`error_log2_64`](crate::range::error_log2_64): 3e-14 γ for eight steps and values near 0.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PairValues {
    dtw: SoftDtw,
    dispatch: Dispatch,
}

/// Two sequences.
pub(crate) type Pair<'a, const D: usize> = (&'a [[f64; D]], &'a [[f64; D]]);

impl PairValues {
    pub(crate) fn new(dtw: SoftDtw, dispatch: Dispatch) -> Self {
        Self { dtw, dispatch }
    }

    pub(crate) fn of<const D: usize>(&self, pairs: &[Pair<'_, D>]) -> Vec<PairValue> {
        let mut values = vec![PairValue::AtLeast(f64::NEG_INFINITY); pairs.len()];
        if !GAMMAS.contains(&self.dtw.gamma) {
            return values;
        }
        let lengths = |&index: &usize| (pairs[index].0.len(), pairs[index].1.len());
        let mut order: Vec<usize> = (0..pairs.len()).collect();
        order.sort_by_key(lengths);
        let mut block = PairBlock::default();
        for same in order.chunk_by(|a, b| lengths(a) == lengths(b)) {
            let (n, m) = lengths(&same[0]);
            let Some(range) = Range::of_f64(n, m) else {
                continue;
            };
            for indices in same.chunks(STRIP) {
                block.fill(indices.iter().map(|&index| pairs[index]), (n, m));
                let sums = self.sums(range, &mut block);
                for (&index, sum) in indices.iter().zip(sums) {
                    values[index] = self.value(range, sum);
                }
            }
        }
        values
    }

    /// `D_γ` of every pair of checked sequences; pairs beyond the range are evaluated one by one.
    pub(crate) fn all<const D: usize>(&self, pairs: &[Pair<'_, D>]) -> Vec<f64> {
        let value = |(&(x, y), value): (&Pair<'_, D>, _)| match value {
            PairValue::Known(value) => value,
            PairValue::AtLeast(_) => self.dtw.value_unchecked(x, y),
        };
        pairs.iter().zip(self.of(pairs)).map(value).collect()
    }

    /// Sums over the warping paths of a block, start value included.
    fn sums<const D: usize>(&self, range: Range, block: &mut PairBlock<D>) -> Lanes {
        let mut sums = [0.0; STRIP];
        self.dispatch.run(PairRecursion {
            block,
            start: f64::from(range.start_log2).exp2(),
            scale: -std::f64::consts::LOG2_E / self.dtw.gamma,
            cost: self.dtw.cost,
            sums: &mut sums,
        });
        sums
    }

    fn value(&self, range: Range, sum: f64) -> PairValue {
        let gamma = self.dtw.gamma;
        let start = f64::from(range.start_log2);
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

/// Up to eight pairs of equal lengths, one per lane, and a row of the recursion.
#[derive(Default)]
struct PairBlock<const D: usize> {
    x: Vec<[Lanes; D]>,
    y: Vec<[Lanes; D]>,
    row: Vec<Lanes>,
}

impl<const D: usize> PairBlock<D> {
    /// Free lanes repeat the last pair, so that they are not slower or out of range.
    fn fill<'a>(&mut self, pairs: impl Iterator<Item = Pair<'a, D>>, (n, m): (usize, usize)) {
        self.x.resize(n, [[0.0; STRIP]; D]);
        self.y.resize(m, [[0.0; STRIP]; D]);
        self.row.resize(m, [0.0; STRIP]);
        for (lane, (x, y)) in pairs.enumerate() {
            for (steps, lanes) in [(x, &mut self.x), (y, &mut self.y)] {
                for (step, lanes) in steps.iter().zip(lanes) {
                    for (component, lanes) in step.iter().zip(lanes) {
                        lanes[lane..].fill(*component);
                    }
                }
            }
        }
    }
}

/// The recursion of [`crate::recursion`] in `f64`, on eight pairs.
struct PairRecursion<'a, const D: usize> {
    block: &'a mut PairBlock<D>,
    start: f64,
    scale: f64,
    cost: Cost,
    sums: &'a mut Lanes,
}

impl<const D: usize> Kernel for PairRecursion<'_, D> {
    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let PairBlock { x, y, row } = self.block;
        let zero = f64x8::splat(simd, 0.0);
        row.fill([0.0; STRIP]);
        let mut corner = f64x8::splat(simd, self.start);
        let mut left = zero;
        for x in x {
            let mut diagonal = corner;
            left = zero;
            for (cell, y) in row.iter_mut().zip(&*y) {
                let mut cost = zero;
                for d in 0..D {
                    let difference = f64x8::load_array_ref(simd, &x[d]) - f64x8::load_array_ref(simd, &y[d]);
                    cost += difference * difference;
                }
                if self.cost == Cost::Euclidean {
                    cost = cost.sqrt();
                }
                let (factor, integer) = exp2_parts(simd, (cost * self.scale).max(-COST_LIMIT_64));
                let up = f64x8::load_array_ref(simd, cell);
                left = times_power(factor, integer) * ((diagonal + up + FLOOR_64) + left);
                left.store_array(cell);
                diagonal = up;
            }
            corner = zero;
        }
        left.store_array(self.sums);
    }
}

#[cfg(test)]
mod tests;
