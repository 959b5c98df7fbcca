//! The forward pass, parallel over tiles of rows.

use crate::kernel::buffer::Buffer;
use crate::kernel::columns::{MatrixColumns, MatrixColumnsMut};
use crate::kernel::dropout::Dropout;
use crate::kernel::feed_forward::dropout::UnitDecisions;
use crate::kernel::feed_forward::layer::{FeedForward, ROWS_AT_ONCE};
use crate::kernel::product::{BLOCK, End, Start, multiply};
use crate::kernel::threads::run_each;
use ddl_simd::{Simd, TiledKernel};

/// Largest number of rows in a tile. Its x and y and a block's weights fit the second-level cache.
const TILE: usize = 256;
/// The number of rows of a tile is a multiple of this, which is a multiple of the rows of accumulators.
const ROWS: usize = 8;

impl FeedForward {
    /// y for every row of x.
    /// `x` `[rows, width]` -> `y` `[rows, width]`, overwritten.
    ///
    /// For finite sums, the error of an entry is at most (width + hidden + 8) 2^-24 times the formula with the absolute
    /// values of all its terms and without `ReLU`. An entry depends neither on the number of threads nor on the other
    /// rows.
    pub(crate) fn forward(&self, x: &[f32], dropout: Option<Dropout>, y: &mut [f32]) {
        let width = self.width();
        assert_eq!(x.len() % width, 0, "x is not made of rows of {width}");
        assert_eq!(x.len(), y.len(), "entries of x and y");
        let rows = x.len() / width;
        let decisions = dropout.and_then(|dropout| UnitDecisions::new(dropout, rows));
        // Each thread gets the same number of tiles. The result of a row does not depend on its tile.
        let tiles = rows.div_ceil(TILE).next_multiple_of(rayon::current_num_threads());
        let size = rows.div_ceil(tiles.max(1)).next_multiple_of(ROWS).max(ROWS);
        let tiles = x.chunks(size * width).zip(y.chunks_mut(size * width)).enumerate();
        let jobs = tiles.map(|(tile, (x, y))| RowsForward {
            layer: self,
            decisions: decisions.as_ref(),
            first: tile * size,
            x,
            y,
        });
        run_each(self.dispatch, jobs, 2 * x.len() * self.hidden());
    }
}

struct RowsForward<'a> {
    layer: &'a FeedForward,
    decisions: Option<&'a UnitDecisions>,
    first: usize,
    x: &'a [f32],
    y: &'a mut [f32],
}

impl TiledKernel for RowsForward<'_> {
    #[inline(always)]
    fn run<S: Simd, const R: usize, const V: usize>(self, simd: S) {
        let (layer, width) = (self.layer, self.layer.width());
        let mut hidden = Buffer::any(ROWS_AT_ONCE * BLOCK);
        for block in 0..layer.units() {
            let start = if block == 0 { Start::Row(&layer.after.bias) } else { Start::There };
            let pieces = self.x.chunks(ROWS_AT_ONCE * width);
            for (piece, (x, y)) in pieces.zip(self.y.chunks_mut(ROWS_AT_ONCE * width)).enumerate() {
                let hidden = &mut hidden[..x.len() / width * BLOCK];
                let decisions = self.decisions.map(|decisions| (decisions, self.first + piece * ROWS_AT_ONCE));
                layer.activate::<S, R, V>(simd, block, x, decisions, hidden);
                let count = layer.units_of(block);
                multiply::<S, R, V>(
                    simd,
                    MatrixColumns::first(hidden, BLOCK, count),
                    layer.after.transposed.rows(block * BLOCK, count),
                    (start, End::Unchanged),
                    &mut MatrixColumnsMut::whole(y, width),
                );
            }
        }
    }
}
