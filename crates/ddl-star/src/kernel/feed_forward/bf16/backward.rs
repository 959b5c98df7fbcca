//! One group of hidden units over one span of rows of the backward pass.

#![expect(clippy::inline_always, reason = "kernels are compiled for the set")]
#![expect(
    clippy::needless_range_loop,
    reason = "loops of a known count over registers"
)]

use super::forward::activate;
use super::product::{ROWS, Sums, add_product, add_transposed_product, multiply};
use super::{PairPanel, PairedRow, Rounded, TwoRows};
use crate::kernel::feed_forward::backward::{KEPT, Scratch};
use crate::kernel::feed_forward::block::{BLOCK, Block, PARTS, tile_mut};
use crate::kernel::feed_forward::dropout::Decisions;
use crate::kernel::feed_forward::gradients::Part;
use crate::kernel::feed_forward::product::store_tile;
use crate::kernel::feed_forward::weights::{Unit, Weights};
use crate::kernel::simd::{PairKernel, Pairs, Simd};

/// Fields as in the group of `f32`.
pub(in crate::kernel::feed_forward) struct PairBackward<'a, 'b> {
    pub(in crate::kernel::feed_forward) weights: &'a Weights<PairPanel>,
    pub(in crate::kernel::feed_forward) decisions: Option<&'a Decisions>,
    pub(in crate::kernel::feed_forward) first: usize,
    pub(in crate::kernel::feed_forward) units: usize,
    pub(in crate::kernel::feed_forward) x: &'a Rounded,
    pub(in crate::kernel::feed_forward) gy: &'a Rounded,
    pub(in crate::kernel::feed_forward) scratch: &'a mut Scratch,
    pub(in crate::kernel::feed_forward) part: &'a mut Part<'b>,
}

impl PairKernel for PairBackward<'_, '_> {
    #[inline(always)]
    fn run<P: Pairs>(self, pairs: P) {
        let Self {
            weights,
            decisions,
            first,
            units,
            x,
            gy,
            scratch,
            part,
        } = self;
        let Scratch { gx, w1, w2 } = scratch;
        let columns = weights.sizes.columns;
        let scale = match decisions {
            Some(decisions) => decisions.scale,
            None => 1.0,
        };
        let [mut hidden, mut gradient] = [[Block::ZERO; ROWS]; 2];
        let mut gradient_rows = [PairedRow::ZERO; ROWS];
        // Of the rows kept for the derivatives of the weights.
        let [mut hidden_kept, mut gradient_kept] = [[TwoRows::ZERO; KEPT / 2]; 2];
        for column in 0..columns {
            gx.column_mut(column).fill(Block::ZERO);
        }
        for u in 0..part.b1.len().div_ceil(BLOCK) {
            let unit = units + u;
            let of_unit = weights.unit(unit);
            w1.fill([Block::ZERO; BLOCK]);
            w2.fill([Block::ZERO; BLOCK]);
            for start in (0..x.count).step_by(KEPT) {
                let count = KEPT.min(x.count - start);
                let mut b1 = Block::ZERO;
                for r in (0..count).step_by(ROWS) {
                    let row = start + r;
                    activate(pairs, of_unit, x, row, &mut hidden);
                    if let Some(decisions) = decisions {
                        decisions.apply(pairs.simd(), &mut hidden, first + row, unit);
                    }
                    deactivate(
                        pairs,
                        of_unit,
                        gy,
                        row,
                        scale,
                        &hidden,
                        &mut gradient,
                        &mut b1,
                    );
                    for i in 0..ROWS {
                        gradient_rows[i].round(pairs, &gradient[i]);
                    }
                    let kept = r / 2..r / 2 + ROWS / 2;
                    round_two_by_two(pairs, &hidden, &mut hidden_kept[kept.clone()]);
                    round_two_by_two(pairs, &gradient, &mut gradient_kept[kept]);
                    for column in 0..columns {
                        let gx = tile_mut(gx.column_mut(column), row);
                        add_product(pairs, gx, &gradient_rows, of_unit.w1(column));
                    }
                }
                b1.add_to(&mut part.b1[u * BLOCK..]);
                let [hidden, gradient] = [&hidden_kept[..count / 2], &gradient_kept[..count / 2]];
                for column in 0..columns {
                    let x = x.two_by_two(column, start, count);
                    let gy = gy.two_by_two(column, start, count);
                    add_transposed_product(pairs, &mut w1[column], gradient, x);
                    add_transposed_product(pairs, &mut w2[column], gy, hidden);
                }
            }
            part.add(u, [w1, w2], weights.sizes);
        }
    }
}

/// As that of `f32`, with the sums over the rows added to those of the derivative of b1.
#[inline(always)]
#[expect(clippy::too_many_arguments, reason = "inlined into the one caller")]
fn deactivate<P: Pairs>(
    pairs: P,
    unit: Unit<'_, PairPanel>,
    gy: &Rounded,
    row: usize,
    scale: f32,
    hidden: &[Block; ROWS],
    gradient: &mut [Block; ROWS],
    b1: &mut Block,
) {
    let simd = pairs.simd();
    let mut sum: Sums<P> = [[simd.splat(0.0); PARTS]; ROWS];
    for column in 0..unit.columns() {
        sum = multiply(pairs, sum, gy.tile(column, row), unit.w2(column));
    }
    for v in 0..PARTS {
        let mut total = simd.load(b1.part(v));
        for r in 0..ROWS {
            let scaled = simd.mul(sum[r][v], simd.splat(scale));
            sum[r][v] = simd.zero_unless_positive(simd.load(hidden[r].part(v)), scaled);
            total = simd.add(total, sum[r][v]);
        }
        simd.store(total, b1.part_mut(v));
    }
    store_tile(simd, &sum, gradient, 0);
}

#[inline(always)]
fn round_two_by_two<P: Pairs>(pairs: P, from: &[Block; ROWS], into: &mut [TwoRows]) {
    for (rows, into) in from.as_chunks().0.iter().zip(into) {
        into.round(pairs, rows);
    }
}
