//! One tile of rows of the forward pass.

#![expect(clippy::inline_always, reason = "kernels are compiled for the set")]
#![expect(
    clippy::needless_range_loop,
    reason = "loops of a known count over registers"
)]

use super::product::{ROWS, Sums, add_product, multiply};
use super::{PairPanel, PairedRow, Squares};
use crate::kernel::feed_forward::block::{Block, PARTS, tile_mut};
use crate::kernel::feed_forward::product::store_tile;
use crate::kernel::feed_forward::tile::Tile;
use ddl_simd::{PairKernel, Pairs, Simd};

/// The tile, with rounded weights.
pub(in crate::kernel::feed_forward) struct PairForward<'a> {
    pub(in crate::kernel::feed_forward) tile: Tile<'a>,
    pub(in crate::kernel::feed_forward) squares: &'a Squares,
}

impl PairKernel for PairForward<'_> {
    #[inline(always)]
    fn run<P: Pairs>(self, pairs: P) {
        let Self {
            tile:
                Tile {
                    weights,
                    decisions,
                    first,
                    x,
                    y,
                },
            squares,
        } = self;
        let columns = weights.columns;
        // The blocks of the first rows, those of the next ones, and so on.
        let mut rounded_x = vec![[PairedRow::ZERO; ROWS]; columns * x.rows() / ROWS];
        for (tile, rounded) in rounded_x.iter_mut().enumerate() {
            let (row, column) = (tile / columns * ROWS, tile % columns);
            for r in 0..ROWS {
                rounded[r].round(pairs, &x.column(column)[row + r]);
            }
        }
        for column in 0..columns {
            y.column_mut(column).fill(weights.b2[column]);
        }
        let mut hidden = [Block::ZERO; ROWS];
        let mut rounded = [PairedRow::ZERO; ROWS];
        for unit in 0..weights.units {
            let b1 = weights.unit(unit).b1();
            let of_unit = unit * columns..(unit + 1) * columns;
            let w1_transposed = &squares.w1_transposed[of_unit.clone()];
            let w2_transposed = &squares.w2_transposed[of_unit];
            for (tile, x) in rounded_x.chunks_exact(columns).enumerate() {
                let row = tile * ROWS;
                activate(pairs, b1, w1_transposed, x, &mut hidden);
                if let Some(decisions) = decisions {
                    decisions.apply(pairs.simd(), &mut hidden, first + row, unit);
                }
                for r in 0..ROWS {
                    rounded[r].round(pairs, &hidden[r]);
                }
                for (column, w2) in w2_transposed.iter().enumerate() {
                    let y = tile_mut(y.column_mut(column), row);
                    add_product(pairs, y, &rounded, w2);
                }
            }
        }
    }
}

/// relu(W1 x + b1) of a block of units, for some rows, in `f32`.
#[inline(always)]
fn activate<P: Pairs>(
    pairs: P,
    b1: &Block,
    w1_transposed: &[PairPanel],
    x: &[[PairedRow; ROWS]],
    hidden: &mut [Block; ROWS],
) {
    let simd = pairs.simd();
    let b1 = [simd.load(b1.part(0)), simd.load(b1.part(1))];
    let mut sum: Sums<P> = [b1; ROWS];
    for (x, w1) in x.iter().zip(w1_transposed) {
        sum = multiply(pairs, sum, x, w1);
    }
    for r in 0..ROWS {
        for v in 0..PARTS {
            sum[r][v] = simd.max(simd.splat(0.0), sum[r][v]);
        }
    }
    store_tile(simd, &sum, hidden, 0);
}
