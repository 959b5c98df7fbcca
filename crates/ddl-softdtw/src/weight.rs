//! R, the sum of exp(−cost/γ) over paths: a significand and an integer exponent that never leaves its range.
#![expect(clippy::inline_always, reason = "the lanes must stay in registers")]

use crate::exp2::times_power;
use crate::grid::STRIP;
use ddl_simd::Simd;
use fearless_simd::f64x8;
use fearless_simd::prelude::*;

/// A positive normal number and an exponent, an exact integer: the product of the number and a power of two.
pub(crate) type Weight = [f64; 2];
/// R of the cells of one antidiagonal of a strip.
pub(crate) type Cells<S> = [f64x8<S>; 2];

/// R = 0: no path reaches the cell. The exponent, −2^60, is far below every other, far from overflow.
pub(crate) const NONE: Weight = [1.0, -1_152_921_504_606_846_976.0];
/// Smallest exponent of an addend, relative to the largest. Such an addend does not change the sum, and is a normal
/// number.
const FARTHEST: f64 = -700.0;
/// Shares of about this, 2^−142, or less are set to 0.
const NEGLIGIBLE: f64 = f64::from_bits((1023 - 142) << 52);

const ONE: u64 = 1.0_f64.to_bits();
const FRACTION: u64 = u64::MAX >> 12;
/// 2^52: the low bits of this and the next numbers are integers.
const INTEGERS: f64 = 4_503_599_627_370_496.0;

/// The lanes moved down by one row, `top` above them.
#[inline(always)]
pub(crate) fn below<S: Simd>(simd: S, [significand, exponent]: Cells<S>, top: Weight) -> Cells<S> {
    let [top, top_exponent] = splat(simd, top);
    [top.slide::<{ STRIP - 1 }>(significand), top_exponent.slide::<{ STRIP - 1 }>(exponent)]
}

/// The lanes moved up by one row, `bottom` below them.
#[inline(always)]
pub(crate) fn above<S: Simd>(simd: S, [significand, exponent]: Cells<S>, bottom: Weight) -> Cells<S> {
    let [bottom, bottom_exponent] = splat(simd, bottom);
    [significand.slide::<1>(bottom), exponent.slide::<1>(bottom_exponent)]
}

#[inline(always)]
pub(crate) fn splat<S: Simd>(simd: S, [significand, exponent]: Weight) -> Cells<S> {
    [f64x8::splat(simd, significand), f64x8::splat(simd, exponent)]
}

/// R = 1 in lane `lane`, 0 in the other lanes.
#[inline(always)]
pub(crate) fn only<S: Simd>(simd: S, lane: usize) -> Cells<S> {
    let [significand, none] = NONE;
    let mut exponents = [none; STRIP];
    exponents[lane] = 0.0;
    [f64x8::splat(simd, significand), f64x8::load_array(simd, exponents)]
}

#[inline(always)]
pub(crate) fn lane<S: Simd>([significand, exponent]: Cells<S>, lane: usize) -> Weight {
    [significand[lane], exponent[lane]]
}

/// The sum over the three predecessors (or successors) of each cell, and `factor` times this sum. The first one is
/// the diagonal. The other two are added first, so that (y, x) gives the same bits as (x, y).
#[inline(always)]
pub(crate) fn sums<S: Simd>(ways: [Cells<S>; 3], factor: Cells<S>) -> [Cells<S>; 2] {
    let [[_, diagonal], [_, up], [_, left]] = ways;
    let top = diagonal.max(up).max(left);
    let mut addends = [top; 3];
    for (addend, [significand, exponent]) in addends.iter_mut().zip(ways) {
        *addend = times_power(significand, (exponent - top).max(FARTHEST));
    }
    let [diagonal, up, left] = addends;
    let sum = (up + left) + diagonal;
    [[sum, top], [factor[0] * sum, factor[1] + top]]
}

/// The same numbers with every significand in [1, 2).
#[inline(always)]
pub(crate) fn normalised<S: Simd>([significand, exponent]: Cells<S>) -> Cells<S> {
    let bits = significand.to_bits();
    // The biased exponent as a number.
    let biased = f64x8::<S>::from_bits((bits >> 52) | INTEGERS.to_bits()) - INTEGERS;
    [f64x8::from_bits((bits & FRACTION) | ONE), exponent + (biased - 1023.0)]
}

pub(crate) fn normalised_one([significand, exponent]: Weight) -> Weight {
    let bits = significand.to_bits();
    let shift = (bits >> 52) as f64 - 1023.0;
    [f64::from_bits(bits & FRACTION | ONE), exponent + shift]
}

/// a b / `significand`, 0 if it is negligible.
#[inline(always)]
pub(crate) fn shares<S: Simd>(simd: S, a: Cells<S>, b: Cells<S>, significand: f64) -> f64x8<S> {
    // The significands are from 2^−256 to 2^912: with 2^−2000 a share is negligible.
    let share = a[0] * (1.0 / significand) * b[0];
    let share = times_power(share, (a[1] + b[1]).max(-2000.0));
    share.simd_gt(NEGLIGIBLE).select(share, f64x8::splat(simd, 0.0))
}
