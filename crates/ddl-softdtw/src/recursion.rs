//! The recursion on sixteen candidates at once, in `f32` and the exponential domain.
//!
//! With K = 2^−cost and costs in log2 units, R(i, j) = K(i, j) (R(i−1, j−1) + R(i−1, j) + R(i, j−1)) sums 2^−cost over all
//! warping paths: no exponential and no logarithm in the recursion.
//!
//! # Range
//! Costs are clamped and a floor is added to every sum of three predecessors ([`Simd::exp2`], [`Simd::cell`]), so that
//! every product is a normal number. What both do to small scores is bounded in [`crate::range`].

#![expect(clippy::inline_always, reason = "the lanes must stay in registers")]

use crate::lanes::{Lanes, Simd};

/// Scores of one part of a block: start · Σ over warping paths of 2^−cost, for each lane.
///
/// # Shapes
/// `query`: n steps; `block`: m steps of D components of sixteen lanes; `row`: m registers of working memory.
#[inline(always)]
pub(crate) fn recursion<S: Simd, const D: usize>(
    simd: S,
    query: &[[f32; D]],
    block: &[[Lanes; D]],
    part: usize,
    start: S::Narrow,
    row: &mut [S::Narrow],
) -> S::Narrow {
    let zero = simd.splat(0.0);
    row.fill(zero);
    let mut corner = start;
    let mut left = zero;
    for step in query {
        let mut diagonal = corner;
        left = zero;
        for (cell, candidates) in row.iter_mut().zip(block) {
            let k = simd.exp2(minus_cost(simd, step, candidates, part));
            let up = *cell;
            left = simd.cell(k, diagonal, up, left);
            *cell = left;
            diagonal = up;
        }
        corner = zero;
    }
    left
}

/// −|x − y|² of a query step and one step of each candidate.
#[inline(always)]
fn minus_cost<S: Simd, const D: usize>(
    simd: S,
    step: &[f32; D],
    candidates: &[Lanes; D],
    part: usize,
) -> S::Narrow {
    let mut sum = simd.splat(0.0);
    for d in 0..D {
        let difference = simd.sub(simd.splat(step[d]), simd.load(&candidates[d], part));
        sum = simd.neg_mul_add(difference, difference, sum);
    }
    sum
}
