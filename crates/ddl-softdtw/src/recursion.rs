//! The recursion on sixteen candidates at once, in `f32` and the exponential domain.
//!
//! With K = 2^−cost and costs in log2 units, R(i, j) = K(i, j) (R(i−1, j−1) + R(i−1, j) + R(i, j−1)) sums 2^−cost over
//! all warping paths: no exponential and no logarithm in the recursion.
//!
//! Costs are clamped, and a floor is added to every product or, without fused multiplication, to every sum, so that
//! all products are normal numbers: denormal numbers would make the recursion ten times slower. [`crate::range`] bounds
//! the effect of both on small scores.

#![expect(clippy::inline_always, reason = "the lanes must stay in registers")]

use ddl_simd::{Lanes, Simd, exp2_each};
use fearless_simd::prelude::*;
#[cfg(target_arch = "x86_64")]
use fearless_simd::{Level, f32x16};

use crate::blocks::Step;
use crate::range::{COST_LIMIT, FUSED_FLOOR, UNFUSED_FLOOR};

/// Number of cells whose similarities are computed together if the compiler does not know the length of a sequence:
/// enough independent operations to hide their latency.
pub(crate) const GROUP: usize = 4;

/// The lanes of a group that fill register `part`.
#[inline(always)]
pub(crate) fn load<S: Simd>(simd: S, lanes: &Lanes, part: usize) -> S::f32s {
    let width = <S::f32s as SimdBase<S>>::LEN;
    S::f32s::from_slice(simd, &lanes.0[part * width..][..width])
}

/// Scores of one part of a block: start · Σ over warping paths of 2^−cost, for each lane.
///
/// # Shapes
/// `query`: n steps; `block`: m steps; `row`: m registers of working memory, of any content. If the compiler knows m,
/// the row stays in registers. Similarities are computed G at a time: m, or [`GROUP`].
#[inline(always)]
pub(crate) fn recursion<S: Simd, const D: usize, const G: usize>(
    simd: S,
    query: &[[f32; D]],
    block: &[Step<D>],
    part: usize,
    start: S::f32s,
    row: &mut [S::f32s],
) -> S::f32s {
    let zero = S::f32s::splat(simd, 0.0);
    let steps = block.len();
    row.fill(zero);
    let mut corner = start;
    let mut left = zero;
    for step in query {
        let mut diagonal = corner;
        left = zero;
        let mut first = 0;
        while first < steps {
            let ks = similarities::<S, D, G>(simd, step, block, first, part);
            for g in 0..G {
                if first + g < steps {
                    let up = row[first + g];
                    // K (diagonal + up + left). `left` is available last, so it is added last.
                    left = if <S::f32s as SimdBase<S>>::LEN < 8 {
                        ks[g] * (diagonal + up + UNFUSED_FLOOR + left)
                    } else {
                        ks[g].mul_add(left, ks[g].mul_add(diagonal + up, FUSED_FLOOR))
                    };
                    row[first + g] = left;
                    diagonal = up;
                }
            }
            first += G;
        }
        corner = zero;
    }
    left
}

/// 2^−|x − y|² of a query step x and up to G steps y from `first` on.
#[inline(always)]
fn similarities<S: Simd, const D: usize, const G: usize>(
    simd: S,
    step: &[f32; D],
    block: &[Step<D>],
    first: usize,
    part: usize,
) -> [S::f32s; G] {
    let mut exponents = [S::f32s::splat(simd, 0.0); G];
    for g in 0..G {
        if first + g < block.len() {
            for d in 0..D {
                let difference = load(simd, &block[first + g][d], part) - step[d];
                exponents[g] = (-difference).mul_add(difference, exponents[g]);
            }
        }
        exponents[g] = exponents[g].max(-COST_LIMIT);
    }
    #[cfg(target_arch = "x86_64")]
    if let Level::Avx512(avx512) = simd.level() {
        let exponents = exponents.map(
            #[inline(always)]
            |exponent| f32x16::from_slice(avx512, exponent.as_slice()),
        );
        return exp2_of_512_bits(avx512, exponents).map(
            #[inline(always)]
            |power| S::f32s::from_slice(simd, power.as_slice()),
        );
    }
    exp2_each(simd, exponents)
}

/// 2^f on [0, 1], degree 5 (Remez exchange, 7.5e-8).
#[cfg(target_arch = "x86_64")]
#[expect(clippy::excessive_precision, reason = "digits as printed by the Remez exchange")]
const POLYNOMIAL: [f32; 6] = [
    0.999_999_9,
    0.693_153_07,
    0.240_153_62,
    0.055_826_318,
    0.008_989_34,
    0.001_877_576_7,
];

/// [`exp2_each`] with an instruction for exponent − floor(exponent) and one for the power of two: a sixth less time for
/// a search.
#[cfg(target_arch = "x86_64")]
#[inline(always)]
fn exp2_of_512_bits<const G: usize>(
    simd: fearless_simd::x86::Avx512,
    exponents: [f32x16<fearless_simd::x86::Avx512>; G],
) -> [f32x16<fearless_simd::x86::Avx512>; G] {
    let mut fractions = exponents;
    for g in 0..G {
        fractions[g] = above_floor(simd, exponents[g]);
    }
    let [lower @ .., highest] = POLYNOMIAL;
    let mut powers = [f32x16::splat(simd, highest); G];
    for coefficient in lower.into_iter().rev() {
        for g in 0..G {
            powers[g] = powers[g].mul_add(fractions[g], coefficient);
        }
    }
    for g in 0..G {
        powers[g] = times_power_of_floor(simd, powers[g], exponents[g]);
    }
    powers
}

#[cfg(target_arch = "x86_64")]
fearless_simd::kernel!(
    #[inline(always)]
    fn above_floor(simd: Avx512, a: f32x16<fearless_simd::x86::Avx512>) -> f32x16<fearless_simd::x86::Avx512> {
        use std::arch::x86_64::{_MM_FROUND_FLOOR, _mm512_reduce_ps};
        _mm512_reduce_ps::<{ _MM_FROUND_FLOOR }>(a.into()).simd_into(simd)
    }
);

#[cfg(target_arch = "x86_64")]
fearless_simd::kernel!(
    #[inline(always)]
    fn times_power_of_floor(
        simd: Avx512,
        power: f32x16<fearless_simd::x86::Avx512>,
        exponent: f32x16<fearless_simd::x86::Avx512>,
    ) -> f32x16<fearless_simd::x86::Avx512> {
        std::arch::x86_64::_mm512_scalef_ps(power.into(), exponent.into()).simd_into(simd)
    }
);
