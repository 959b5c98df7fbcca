//! Representations of R, the sum of exp(−cost/γ) over paths: a plain number, or a number with a separate exponent.
#![expect(clippy::inline_always, reason = "the lanes must stay in registers")]

use ddl_simd::Simd;
use fearless_simd::f64x8;
use fearless_simd::prelude::*;

use crate::exp2::{exp2_parts, times_power};
use crate::grid::STRIP;

/// Exponent of a cell that no path reaches: far below every other, far from overflow.
const NOTHING: f64 = -1_152_921_504_606_846_976.0; // −2^60
/// Smallest exponent of an addend, relative to the largest. Such an addend does not change the sum, and is a normal
/// number.
const FARTHEST: f64 = -700.0;
/// Bits of 2^−1018. Plain numbers are at least half of it, because products of denormal numbers would take a hundred
/// times as long.
const FLOOR: u64 = (1023 - 1018) << 52;
/// Shares of about this, 2^−142, or less are set to 0.
const NEGLIGIBLE: f64 = f64::from_bits((1023 - 142) << 52);

/// The exponent of the total in shares of [`Plain`] numbers.
pub(crate) const TOTAL: f64 = 145.0;

const ONE: u64 = 1.0_f64.to_bits();
const FRACTION: u64 = u64::MAX >> 12;
/// 2^52: the low bits of this and the next numbers are integers.
const INTEGERS: f64 = 4_503_599_627_370_496.0;

/// R of the cells of one antidiagonal of a strip, in `C` numbers for each cell.
pub(crate) type Cells<S, const C: usize> = [f64x8<S>; C];

/// A significand and an exponent, or the sum of them.
pub(crate) type Total = (f64, f64);

/// Arithmetic on R in `C` numbers. Both representations round at the same points, so they give the same bits if the
/// plain one suffices.
pub(crate) trait Weight<const C: usize> {
    /// R = 0: no path reaches the cell.
    const NONE: [f64; C];

    fn power(exponent: f64) -> [f64; C];

    /// 2^`minus_t`.
    fn exp2<S: Simd>(simd: S, minus_t: f64x8<S>) -> Cells<S, C>;

    /// The sum over the three predecessors (or successors) of each cell, and `factor` times this sum. The first one is
    /// the diagonal. The other two are added first, so that (y, x) gives the same bits as (x, y).
    fn cells<S: Simd>(simd: S, ways: [Cells<S, C>; 3], factor: Cells<S, C>) -> [Cells<S, C>; 2];

    /// The same numbers with every significand in [1, 2).
    fn normalised<S: Simd>(cells: Cells<S, C>) -> Cells<S, C>;

    fn normalised_one(cell: [f64; C]) -> [f64; C];

    fn total(cell: [f64; C]) -> Total;

    /// a b / total, 0 if it is negligible. The plain representation requires a total from 2^[`TOTAL`] to twice that.
    fn shares<S: Simd>(simd: S, a: Cells<S, C>, b: Cells<S, C>, total: Total) -> f64x8<S>;
}

/// The lanes moved down by one row, `top` above them.
#[inline(always)]
pub(crate) fn below<S: Simd, const C: usize>(simd: S, mut cells: Cells<S, C>, top: [f64; C]) -> Cells<S, C> {
    for c in 0..C {
        cells[c] = f64x8::splat(simd, top[c]).slide::<{ STRIP - 1 }>(cells[c]);
    }
    cells
}

/// The lanes moved up by one row, `bottom` below them.
#[inline(always)]
pub(crate) fn above<S: Simd, const C: usize>(simd: S, mut cells: Cells<S, C>, bottom: [f64; C]) -> Cells<S, C> {
    for c in 0..C {
        cells[c] = cells[c].slide::<1>(f64x8::splat(simd, bottom[c]));
    }
    cells
}

#[inline(always)]
pub(crate) fn splat<S: Simd, const C: usize>(simd: S, cell: [f64; C]) -> Cells<S, C> {
    let mut cells = [f64x8::splat(simd, 0.0); C];
    for c in 0..C {
        cells[c] = f64x8::splat(simd, cell[c]);
    }
    cells
}

/// `cell` in lane `lane`, `others` in the other lanes.
#[inline(always)]
pub(crate) fn only<S: Simd, const C: usize>(simd: S, lane: usize, cell: [f64; C], others: [f64; C]) -> Cells<S, C> {
    let mut cells = splat(simd, others);
    for c in 0..C {
        let mut numbers = [others[c]; STRIP];
        numbers[lane] = cell[c];
        cells[c] = f64x8::load_array(simd, numbers);
    }
    cells
}

#[inline(always)]
pub(crate) fn lane<S: Simd, const C: usize>(cells: Cells<S, C>, lane: usize) -> [f64; C] {
    let mut cell = [0.0; C];
    for c in 0..C {
        cell[c] = cells[c][lane];
    }
    cell
}

/// R itself, times a power of two that lets all of it lie in the range of `f64`.
pub(crate) struct Plain;

impl Weight<1> for Plain {
    const NONE: [f64; 1] = [0.0];

    fn power(exponent: f64) -> [f64; 1] {
        [f64::from_bits(((exponent as i64 + 1023) as u64) << 52)]
    }

    #[inline(always)]
    fn exp2<S: Simd>(simd: S, minus_t: f64x8<S>) -> Cells<S, 1> {
        let (factor, integer) = exp2_parts(simd, minus_t);
        [times_power(factor, integer)]
    }

    #[inline(always)]
    fn cells<S: Simd>(
        simd: S,
        [[diagonal], [up], [left]]: [Cells<S, 1>; 3],
        [factor]: Cells<S, 1>,
    ) -> [Cells<S, 1>; 2] {
        // FLOOR / factor within a factor of 2. It is added to the diagonal, which is not on the critical path.
        let sum = (up + left) + (diagonal + quotient(simd, FLOOR, factor));
        [[sum], [factor * sum]]
    }

    #[inline(always)]
    fn normalised<S: Simd>(cells: Cells<S, 1>) -> Cells<S, 1> {
        cells
    }

    fn normalised_one(cell: [f64; 1]) -> [f64; 1] {
        cell
    }

    fn total([number]: [f64; 1]) -> Total {
        split(number)
    }

    #[inline(always)]
    fn shares<S: Simd>(simd: S, [a]: Cells<S, 1>, [b]: Cells<S, 1>, (significand, _): Total) -> f64x8<S> {
        let [total] = Self::power(TOTAL);
        // The product would be denormal below 2^−1022 / b: it is not computed below about NEGLIGIBLE 2^TOTAL / b.
        let negligible = quotient(simd, total.to_bits() - ONE + NEGLIGIBLE.to_bits(), b);
        let a = a.simd_gt(negligible).select(a, f64x8::splat(simd, 0.0));
        a * b * (1.0 / total / significand)
    }
}

/// The number of representation `bits` divided by `divisor`, or up to an eighth more.
#[inline(always)]
fn quotient<S: Simd>(simd: S, bits: u64, divisor: f64x8<S>) -> f64x8<S> {
    f64x8::from_bits(fearless_simd::u64x8::splat(simd, bits + ONE) - divisor.to_bits())
}

/// significand · 2^exponent, with an integer exponent that never leaves its range.
pub(crate) struct Scaled;

impl Weight<2> for Scaled {
    const NONE: [f64; 2] = [1.0, NOTHING];

    fn power(exponent: f64) -> [f64; 2] {
        [1.0, exponent]
    }

    #[inline(always)]
    fn exp2<S: Simd>(simd: S, minus_t: f64x8<S>) -> Cells<S, 2> {
        let (factor, integer) = exp2_parts(simd, minus_t);
        [factor, integer]
    }

    #[inline(always)]
    fn cells<S: Simd>(simd: S, ways: [Cells<S, 2>; 3], factor: Cells<S, 2>) -> [Cells<S, 2>; 2] {
        let [[_, diagonal], [_, up], [_, left]] = ways;
        let top = diagonal.max(up).max(left);
        let mut addends = [top; 3];
        for (addend, [significand, exponent]) in addends.iter_mut().zip(ways) {
            *addend = times_power(significand, (exponent - top).max(FARTHEST));
        }
        let [diagonal, up, left] = addends;
        let sum = (up + left) + diagonal;
        let _ = simd;
        [[sum, top], [factor[0] * sum, factor[1] + top]]
    }

    #[inline(always)]
    fn normalised<S: Simd>([significand, exponent]: Cells<S, 2>) -> Cells<S, 2> {
        let bits = significand.to_bits();
        // The biased exponent as a number.
        let biased = f64x8::<S>::from_bits((bits >> 52) | INTEGERS.to_bits()) - INTEGERS;
        [f64x8::from_bits((bits & FRACTION) | ONE), exponent + (biased - 1023.0)]
    }

    fn normalised_one([significand, exponent]: [f64; 2]) -> [f64; 2] {
        let (significand, shift) = split(significand);
        [significand, exponent + shift]
    }

    fn total(cell: [f64; 2]) -> Total {
        let [significand, exponent] = Self::normalised_one(cell);
        (significand, exponent)
    }

    #[inline(always)]
    fn shares<S: Simd>(simd: S, a: Cells<S, 2>, b: Cells<S, 2>, (significand, exponent): Total) -> f64x8<S> {
        // The significands are from 2^−256 to 2^912: with 2^−2000 a share is negligible.
        let share = a[0] * (1.0 / significand) * b[0];
        let share = times_power(share, (a[1] + b[1] - exponent).max(-2000.0));
        share.simd_gt(NEGLIGIBLE).select(share, f64x8::splat(simd, 0.0))
    }
}

/// A positive normal number as significand in [1, 2) and exponent.
fn split(number: f64) -> Total {
    let bits = number.to_bits();
    let significand = f64::from_bits(bits & FRACTION | ONE);
    (significand, (bits >> 52) as f64 - 1023.0)
}
