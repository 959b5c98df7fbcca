//! The weights as the kernels read them.

use super::block::{BLOCK, Block, Panel, transpose};

/// What a layer's matrices measure, in numbers and in blocks.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sizes {
    pub(super) width: usize,
    pub(super) hidden: usize,
    /// Blocks of a row of x.
    pub(super) columns: usize,
    /// Blocks of hidden units.
    pub(super) units: usize,
}

/// Squares of 32 x 32 weights, those of one block of hidden units together, and padded with zeros: a unit of the padding
/// is 0 and adds nothing.
#[derive(Clone, Debug)]
pub(super) struct Weights<Square = Panel> {
    pub(super) sizes: Sizes,
    w1: Vec<Square>,
    w1_transposed: Vec<Square>,
    w2: Vec<Square>,
    w2_transposed: Vec<Square>,
    b1: Vec<Block>,
    pub(super) b2: Vec<Block>,
}

impl Weights {
    pub(super) fn new([w1, b1, w2, b2]: [&[f32]; 4], width: usize, hidden: usize) -> Self {
        assert!(width > 0 && hidden > 0, "a width of 0");
        let (columns, units) = (width.div_ceil(BLOCK), hidden.div_ceil(BLOCK));
        assert_eq!(w1.len(), hidden * width, "entries of W1");
        assert_eq!(b1.len(), hidden, "entries of b1");
        assert_eq!(w2.len(), width * hidden, "entries of W2");
        assert_eq!(b2.len(), width, "entries of b2");
        let squares = vec![[Block::ZERO; BLOCK]; units * columns];
        let [mut squares1, mut transposed1] = [squares.clone(), squares.clone()];
        let [mut squares2, mut transposed2] = [squares.clone(), squares];
        for unit in 0..units {
            for column in 0..columns {
                let at = unit * columns + column;
                copy_square(w1, width, [unit, column], &mut squares1[at]);
                transpose(&squares1[at], &mut transposed1[at]);
                copy_square(w2, hidden, [column, unit], &mut squares2[at]);
                transpose(&squares2[at], &mut transposed2[at]);
            }
        }
        Self {
            sizes: Sizes {
                width,
                hidden,
                columns,
                units,
            },
            w1: squares1,
            w1_transposed: transposed1,
            w2: squares2,
            w2_transposed: transposed2,
            b1: b1.chunks(BLOCK).map(Block::padded).collect(),
            b2: b2.chunks(BLOCK).map(Block::padded).collect(),
        }
    }

    /// The same with other squares.
    pub(super) fn map<Square>(self, squares: impl Fn(&[Panel]) -> Vec<Square>) -> Weights<Square> {
        Weights {
            sizes: self.sizes,
            w1: squares(&self.w1),
            w1_transposed: squares(&self.w1_transposed),
            w2: squares(&self.w2),
            w2_transposed: squares(&self.w2_transposed),
            b1: self.b1,
            b2: self.b2,
        }
    }
}

impl<Square> Weights<Square> {
    /// Those of one block of hidden units.
    #[inline]
    pub(super) fn unit(&self, unit: usize) -> Unit<'_, Square> {
        Unit {
            weights: self,
            unit,
        }
    }
}

/// The weights of a block of hidden units.
#[derive(Debug)]
pub(super) struct Unit<'a, Square = Panel> {
    weights: &'a Weights<Square>,
    unit: usize,
}

impl<Square> Clone for Unit<'_, Square> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<Square> Copy for Unit<'_, Square> {}

impl<'a, Square> Unit<'a, Square> {
    /// W1, rows hidden units.
    #[inline]
    pub(super) fn w1(self, column: usize) -> &'a Square {
        &self.weights.w1[self.unit * self.weights.sizes.columns + column]
    }

    /// W1^T, rows entries of x.
    #[inline]
    pub(super) fn w1_transposed(self, column: usize) -> &'a Square {
        &self.weights.w1_transposed[self.unit * self.weights.sizes.columns + column]
    }

    /// W2, rows entries of y.
    #[inline]
    pub(super) fn w2(self, column: usize) -> &'a Square {
        &self.weights.w2[self.unit * self.weights.sizes.columns + column]
    }

    /// W2^T, rows hidden units.
    #[inline]
    pub(super) fn w2_transposed(self, column: usize) -> &'a Square {
        &self.weights.w2_transposed[self.unit * self.weights.sizes.columns + column]
    }

    #[inline]
    pub(super) fn b1(self) -> &'a Block {
        &self.weights.b1[self.unit]
    }

    /// Blocks of a row of x.
    #[inline]
    pub(super) fn columns(self) -> usize {
        self.weights.sizes.columns
    }
}

/// The 32 x 32 entries from row 32 i and column 32 j; what is beyond the edge stays as it is.
fn copy_square(matrix: &[f32], columns: usize, [i, j]: [usize; 2], into: &mut Panel) {
    let rows = matrix.chunks_exact(columns).skip(i * BLOCK);
    for (block, row) in into.iter_mut().zip(rows) {
        let row = &row[j * BLOCK..];
        *block = Block::padded(&row[..row.len().min(BLOCK)]);
    }
}
