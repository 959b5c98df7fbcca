//! One tile of rows of the forward pass.

#![expect(clippy::inline_always, reason = "kernels are compiled for the set")]
#![expect(
    clippy::needless_range_loop,
    reason = "loops of a known count over registers"
)]

use super::product::{ROWS, Sums, add_product, multiply};
use super::{PairPanel, PairedRow, Rounded};
use crate::kernel::feed_forward::block::{Block, PARTS, tile_mut};
use crate::kernel::feed_forward::block_rows::BlockRows;
use crate::kernel::feed_forward::dropout::Decisions;
use crate::kernel::feed_forward::product::store_tile;
use crate::kernel::feed_forward::weights::{Unit, Weights};
use crate::kernel::simd::{PairKernel, Pairs, Simd};

/// Fields as in the tile of `f32`.
pub(in crate::kernel::feed_forward) struct PairForward<'a> {
    pub(in crate::kernel::feed_forward) weights: &'a Weights<PairPanel>,
    pub(in crate::kernel::feed_forward) decisions: Option<&'a Decisions>,
    pub(in crate::kernel::feed_forward) first: usize,
    pub(in crate::kernel::feed_forward) x: &'a Rounded,
    pub(in crate::kernel::feed_forward) y: &'a mut BlockRows,
}

impl PairKernel for PairForward<'_> {
    #[inline(always)]
    fn run<P: Pairs>(self, pairs: P) {
        let Self {
            weights,
            decisions,
            first,
            x,
            y,
        } = self;
        let columns = weights.sizes.columns;
        for column in 0..columns {
            y.column_mut(column).fill(weights.b2[column]);
        }
        let mut hidden = [Block::ZERO; ROWS];
        let mut rounded = [PairedRow::ZERO; ROWS];
        for unit in 0..weights.sizes.units {
            let of_unit = weights.unit(unit);
            for row in (0..x.count).step_by(ROWS) {
                activate(pairs, of_unit, x, row, &mut hidden);
                if let Some(decisions) = decisions {
                    decisions.apply(pairs.simd(), &mut hidden, first + row, unit);
                }
                for r in 0..ROWS {
                    rounded[r].round(pairs, &hidden[r]);
                }
                for column in 0..columns {
                    let y = tile_mut(y.column_mut(column), row);
                    add_product(pairs, y, &rounded, of_unit.w2_transposed(column));
                }
            }
        }
    }
}

/// relu(W1 x + b1) of a block of units, for some rows from `row`, in `f32`.
#[inline(always)]
pub(super) fn activate<P: Pairs>(
    pairs: P,
    unit: Unit<'_, PairPanel>,
    x: &Rounded,
    row: usize,
    hidden: &mut [Block; ROWS],
) {
    let simd = pairs.simd();
    let b1 = [simd.load(unit.b1().part(0)), simd.load(unit.b1().part(1))];
    let mut sum: Sums<P> = [b1; ROWS];
    for column in 0..unit.columns() {
        sum = multiply(pairs, sum, x.tile(column, row), unit.w1_transposed(column));
    }
    for r in 0..ROWS {
        for v in 0..PARTS {
            sum[r][v] = simd.max(simd.splat(0.0), sum[r][v]);
        }
    }
    store_tile(simd, &sum, hidden, 0);
}
