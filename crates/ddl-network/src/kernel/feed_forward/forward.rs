//! The forward pass: tiles of rows in parallel.

use super::bf16::forward::PairForward;
use super::block_rows::{BlockRows, ROWS};
use super::dropout::Decisions;
use super::layer::FeedForward;
use super::tile::Tile;
use crate::kernel::dropout::Dropout;
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
        let tile = Tile {
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
