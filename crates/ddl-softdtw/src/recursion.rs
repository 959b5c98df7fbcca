//! The recursion on sixteen candidates at once, in `f32` and the exponential domain.
//!
//! With K = 2^−cost and costs in log2 units, R(i, j) = K(i, j) (R(i−1, j−1) + R(i−1, j) + R(i, j−1)) sums 2^−cost over
//! all warping paths: no exponential and no logarithm in the recursion.
//!
//! Costs are clamped and a floor is added to every sum of three predecessors ([`Register::exp2`], [`cell`]), so that
//! every product is a normal number. [`crate::range`] bounds the effect of both on small scores.

#![expect(clippy::inline_always, reason = "the lanes must stay in registers")]

use ddl_simd::Register;

use crate::blocks::Step;
use crate::range::{FLOOR, FUSED_FLOOR};

/// Number of cells whose similarities are computed together if the compiler does not know the length of a sequence:
/// enough independent operations to hide their latency.
pub(crate) const GROUP: usize = 4;

/// Scores of one part of a block: start · Σ over warping paths of 2^−cost, for each lane.
///
/// # Shapes
/// `query`: n steps; `block`: m steps; `row`: m registers of working memory, of any content. If the compiler knows m,
/// the row stays in registers. Similarities are computed G at a time: m, or [`GROUP`].
#[inline(always)]
pub(crate) fn recursion<S: Register, const D: usize, const G: usize>(
    simd: S,
    query: &[[f32; D]],
    block: &[Step<D>],
    part: usize,
    start: S::Floats,
    row: &mut [S::Floats],
) -> S::Floats {
    let zero = simd.splat(0.0);
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
                    left = cell(simd, ks[g], diagonal, up, left);
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
fn similarities<S: Register, const D: usize, const G: usize>(
    simd: S,
    step: &[f32; D],
    block: &[Step<D>],
    first: usize,
    part: usize,
) -> [S::Floats; G] {
    let mut exponents = [simd.splat(0.0); G];
    for g in 0..G {
        if first + g < block.len() {
            for d in 0..D {
                let y = simd.load(&block[first + g][d].0, part);
                let difference = simd.sub(simd.splat(step[d]), y);
                exponents[g] = simd.neg_mul_add(difference, difference, exponents[g]);
            }
        }
    }
    simd.exp2_each(exponents)
}

/// K (diagonal + up + left), one cell of the recursion, for K of at least 2^−[`COST_LIMIT`](ddl_simd::COST_LIMIT). The
/// floor is added to the sum, so that no product is denormal: denormal numbers would make the recursion ten times
/// slower.
#[inline(always)]
pub(crate) fn cell<S: Register>(
    simd: S,
    k: S::Floats,
    diagonal: S::Floats,
    up: S::Floats,
    left: S::Floats,
) -> S::Floats {
    // `left` is the result of the previous cell and available last, so it is added last.
    let others = simd.add(diagonal, up);
    if S::FUSED {
        let others = simd.mul_add(k, others, simd.splat(FUSED_FLOOR));
        simd.mul_add(k, left, others)
    } else {
        simd.mul(k, simd.add(simd.add(others, simd.splat(FLOOR)), left))
    }
}
