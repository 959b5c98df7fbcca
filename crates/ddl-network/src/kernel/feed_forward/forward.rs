//! The forward pass, parallel over tiles of rows.

use super::block::{BlockRows, ROWS};
use super::dropout::UnitDecisions;
use super::layer::FeedForward;
use super::tile::Tile;
use crate::kernel::dropout::Dropout;
use crate::kernel::threads::each;
use ddl_simd::{Kernel, Simd};

/// Largest number of rows in a tile. Its x and y and a block's weights fit the second-level cache.
const TILE: usize = 256;

impl FeedForward {
    /// y for every row of x.
    /// `x` `[rows, width]` -> `y` `[rows, width]`, overwritten.
    ///
    /// For finite sums, the error of an entry is at most (width + hidden + 8) 2^-24 times the formula with the absolute
    /// values of all its terms and without `ReLU`. An entry depends neither on the number of threads nor on the other
    /// rows.
    pub(crate) fn forward(&self, x: &[f32], dropout: Option<Dropout>, y: &mut [f32]) {
        let weights = &self.weights;
        let width = weights.width;
        assert_eq!(x.len() % width, 0, "x is not made of rows of {width}");
        assert_eq!(x.len(), y.len(), "entries of x and y");
        let rows = x.len() / width;
        let decisions = dropout.and_then(|dropout| UnitDecisions::new(dropout, rows));
        if rows == 0 {
            return;
        }
        // Each thread gets the same number of tiles. The result of a row does not depend on its tile.
        let tiles = rows.div_ceil(TILE).next_multiple_of(rayon::current_num_threads());
        let size = rows.div_ceil(tiles).next_multiple_of(ROWS);
        let tiles = x.chunks(size * width).zip(y.chunks_mut(size * width));
        let tiles: Vec<_> = tiles.enumerate().collect();
        let work = 2 * x.len() * weights.hidden;
        each(tiles, work, |(tile, (x, y)), (): &mut ()| {
            self.dispatch.run(Rows {
                layer: self,
                decisions: decisions.as_ref(),
                first: tile * size,
                x,
                y,
            });
        });
    }
}

/// The rows of a tile. Their copies to blocks and back take whole registers.
struct Rows<'a> {
    layer: &'a FeedForward,
    decisions: Option<&'a UnitDecisions>,
    first: usize,
    x: &'a [f32],
    y: &'a mut [f32],
}

impl Kernel for Rows<'_> {
    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let weights = &self.layer.weights;
        let x = BlockRows::padded(self.x, weights.width);
        let mut result = BlockRows::any(x.rows(), weights.columns);
        simd.run_tiled(Tile {
            weights,
            decisions: self.decisions,
            first: self.first,
            x: &x,
            y: &mut result,
        });
        result.write(self.y, weights.width);
    }
}
