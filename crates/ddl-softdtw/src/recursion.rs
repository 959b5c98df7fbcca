//! The recursion on sixteen candidates at once, in `f32` and the exponential domain.
//!
//! With K = 2^−cost and costs in log2 units, R(i, j) = K(i, j) (R(i−1, j−1) + R(i−1, j) + R(i, j−1)) sums 2^−cost over
//! all warping paths: no exponential and no logarithm in the recursion.
//!
//! Costs are clamped, and a floor is added to every product or, without fused multiplication, to every sum, so that
//! all products are normal numbers: denormal numbers would make the recursion ten times slower. [`crate::range`] bounds
//! the effect of both on small scores.

#![expect(clippy::inline_always, reason = "the lanes must stay in registers")]

use crate::blocks::BlockStep;
use crate::range::{COST_LIMIT, FUSED_FLOOR, UNFUSED_FLOOR};
use ddl_simd::{Lanes, Simd, exp2_each};
use fearless_simd::prelude::*;

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
    block: &[BlockStep<D>],
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
    block: &[BlockStep<D>],
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
    exp2_each(simd, exponents)
}
