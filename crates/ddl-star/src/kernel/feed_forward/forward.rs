//! The forward pass: tiles of rows in parallel.

#![expect(clippy::inline_always, reason = "kernels are compiled for the set")]

use rayon::prelude::*;

use super::bf16::{Rounded, forward::PairForward};
use super::block::{Block, tile_mut};
use super::block_rows::{BlockRows, ROWS};
use super::dropout::Decisions;
use super::hidden::activate;
use super::product::add_product;
use super::weights::{Sizes, Weights};
use super::{Arithmetic, FeedForward};
use crate::kernel::dropout::Dropout;
use crate::kernel::simd::{Simd, TiledKernel};

/// Rows of a tile at most: x and y of the tile and a block's weights fit the second-level cache.
const TILE: usize = 256;

pub(super) fn run(layer: &FeedForward, x: &[f32], dropout: Option<Dropout>, y: &mut [f32]) {
    let Sizes { width, columns, .. } = layer.sizes();
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
    let tiles = x
        .par_chunks(size * width)
        .zip(y.par_chunks_mut(size * width));
    tiles.enumerate().for_each(|(tile, (x, y))| {
        let x = BlockRows::padded(x, width);
        let mut result = BlockRows::zeros(x.rows(), columns);
        let (decisions, first, y_blocks) = (decisions.as_ref(), tile * size, &mut result);
        match &layer.arithmetic {
            Arithmetic::F32(weights, dispatch) => dispatch.run(Forward {
                weights,
                decisions,
                first,
                x: &x,
                y: y_blocks,
            }),
            Arithmetic::Bf16(weights, dispatch) => dispatch.run(PairForward {
                weights,
                decisions,
                first,
                x: &Rounded::rows(*dispatch, &x, columns),
                y: y_blocks,
            }),
        }
        y.fill(0.0);
        result.add_to(0, y, width);
    });
}

/// One tile.
struct Forward<'a> {
    weights: &'a Weights,
    decisions: Option<&'a Decisions>,
    /// The first row's number.
    first: usize,
    x: &'a BlockRows,
    y: &'a mut BlockRows,
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
        for column in 0..weights.sizes.columns {
            y.column_mut(column).fill(weights.b2[column]);
        }
        let mut hidden = [Block::ZERO; R];
        for unit in 0..weights.sizes.units {
            let of_unit = weights.unit(unit);
            for row in (0..x.rows()).step_by(R) {
                activate::<S, R, V>(simd, of_unit, x, row, &mut hidden);
                if let Some(decisions) = decisions {
                    decisions.apply(simd, &mut hidden, first + row, unit);
                }
                for column in 0..weights.sizes.columns {
                    let y = tile_mut(y.column_mut(column), row);
                    add_product::<S, R, V>(simd, y, &hidden, of_unit.w2_transposed(column));
                }
            }
        }
    }
}
