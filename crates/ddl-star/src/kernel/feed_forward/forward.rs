//! The forward pass: tiles of rows in parallel.

#![expect(clippy::inline_always, reason = "kernels are compiled for the set")]

use super::FeedForward;
use super::bf16::forward::PairForward;
use super::block::{Block, tile_mut};
use super::block_rows::{BlockRows, ROWS};
use super::dropout::Decisions;
use super::hidden::activate;
use super::product::add_product;
use super::weights::Weights;
use crate::kernel::dropout::Dropout;
use crate::kernel::simd::{Simd, TiledKernel};
use crate::kernel::threads::each;

/// Rows of a tile at most: x and y of the tile and a block's weights fit the second-level cache.
const TILE: usize = 256;

pub(super) fn run(layer: &FeedForward, x: &[f32], dropout: Option<Dropout>, y: &mut [f32]) {
    let weights = &layer.weights;
    let width = weights.width;
    assert_eq!(x.len() % width, 0, "x is not made of rows of {width}");
    assert_eq!(x.len(), y.len(), "entries of x and y");
    let rows = x.len() / width;
    let decisions = dropout.and_then(|dropout| Decisions::new(dropout, rows));
    if rows == 0 {
        return;
    }
    // As many tiles for each thread. A row's result does not depend on its tile.
    let tiles = rows
        .div_ceil(TILE)
        .next_multiple_of(rayon::current_num_threads());
    let size = rows.div_ceil(tiles).next_multiple_of(ROWS);
    let tiles = x.chunks(size * width).zip(y.chunks_mut(size * width));
    let tiles: Vec<_> = tiles.enumerate().collect();
    let work = 2 * x.len() * weights.hidden;
    each(tiles, work, |(tile, (x, y)), (): &mut ()| {
        let x = BlockRows::padded(x, width);
        let mut result = BlockRows::zeros(x.rows(), weights.columns);
        let tile = Forward {
            weights,
            decisions: decisions.as_ref(),
            first: tile * size,
            x: &x,
            y: &mut result,
        };
        match &layer.rounded {
            None => layer.dispatch.run(tile),
            Some(squares) => layer.pair_dispatch.run(PairForward { tile, squares }),
        }
        y.fill(0.0);
        result.add_to(0, y, width);
    });
}

/// One tile.
pub(super) struct Forward<'a> {
    pub(super) weights: &'a Weights,
    pub(super) decisions: Option<&'a Decisions>,
    /// The first row's number.
    pub(super) first: usize,
    pub(super) x: &'a BlockRows,
    pub(super) y: &'a mut BlockRows,
}

impl TiledKernel for Forward<'_> {
    #[inline(always)]
    fn run<S: Simd, const R: usize, const V: usize>(self, simd: S) {
        let Self {
            weights,
            decisions,
            first,
            x,
            y,
        } = self;
        for column in 0..weights.columns {
            y.column_mut(column).fill(weights.b2[column]);
        }
        let mut hidden = [Block::ZERO; R];
        for unit in 0..weights.units {
            let of_unit = weights.unit(unit);
            for row in (0..x.rows()).step_by(R) {
                activate::<S, R, V>(simd, of_unit, x, row, &mut hidden);
                if let Some(decisions) = decisions {
                    decisions.apply(simd, &mut hidden, first + row, unit);
                }
                for column in 0..weights.columns {
                    let y = tile_mut(y.column_mut(column), row);
                    add_product::<S, R, V>(simd, y, &hidden, of_unit.w2_transposed(column));
                }
            }
        }
    }
}
