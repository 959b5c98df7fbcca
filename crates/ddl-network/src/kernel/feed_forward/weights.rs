//! The weights in the layout of the kernels.

use super::block::{BLOCK, Block, Panel, transpose};

/// Squares of 32 x 32 weights, grouped by block of hidden units and padded with zeros. A unit of the padding is 0 and
/// contributes nothing.
#[derive(Clone, Debug)]
pub(super) struct BlockWeights {
    pub(super) width: usize,
    pub(super) hidden: usize,
    pub(super) columns: usize,
    pub(super) units: usize,
    w1: Vec<Panel>,
    pub(super) w1_transposed: Vec<Panel>,
    w2: Vec<Panel>,
    pub(super) w2_transposed: Vec<Panel>,
    b1: Vec<Block>,
    pub(super) b2: Vec<Block>,
}

impl BlockWeights {
    pub(super) fn new(width: usize, hidden: usize) -> Self {
        assert!(width > 0 && hidden > 0, "a width of 0");
        let (columns, units) = (width.div_ceil(BLOCK), hidden.div_ceil(BLOCK));
        let squares = vec![[Block::ZERO; BLOCK]; units * columns];
        Self {
            width,
            hidden,
            columns,
            units,
            w1: squares.clone(),
            w1_transposed: squares.clone(),
            w2: squares.clone(),
            w2_transposed: squares,
            b1: vec![Block::ZERO; units],
            b2: vec![Block::ZERO; columns],
        }
    }

    pub(super) fn update(&mut self, [w1, b1, w2, b2]: [&[f32]; 4]) {
        let (width, hidden) = (self.width, self.hidden);
        assert_eq!(w1.len(), hidden * width, "entries of W1");
        assert_eq!(b1.len(), hidden, "entries of b1");
        assert_eq!(w2.len(), width * hidden, "entries of W2");
        assert_eq!(b2.len(), width, "entries of b2");
        for unit in 0..self.units {
            for column in 0..self.columns {
                let at = unit * self.columns + column;
                copy_square(w1, width, [unit, column], &mut self.w1[at]);
                transpose(&self.w1[at], &mut self.w1_transposed[at]);
                copy_square(w2, hidden, [column, unit], &mut self.w2[at]);
                transpose(&self.w2[at], &mut self.w2_transposed[at]);
            }
        }
        for (block, b1) in self.b1.iter_mut().zip(b1.chunks(BLOCK)) {
            *block = Block::padded(b1);
        }
        for (block, b2) in self.b2.iter_mut().zip(b2.chunks(BLOCK)) {
            *block = Block::padded(b2);
        }
    }

    #[inline]
    pub(super) fn unit(&self, unit: usize) -> Unit<'_> {
        Unit { weights: self, unit }
    }
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Unit<'a> {
    weights: &'a BlockWeights,
    unit: usize,
}

impl<'a> Unit<'a> {
    /// W1; rows are hidden units.
    #[inline]
    pub(super) fn w1(self, column: usize) -> &'a Panel {
        &self.weights.w1[self.unit * self.weights.columns + column]
    }

    /// W1^T; rows are entries of x.
    #[inline]
    pub(super) fn w1_transposed(self, column: usize) -> &'a Panel {
        &self.weights.w1_transposed[self.unit * self.weights.columns + column]
    }

    /// W2; rows are entries of y.
    #[inline]
    pub(super) fn w2(self, column: usize) -> &'a Panel {
        &self.weights.w2[self.unit * self.weights.columns + column]
    }

    /// W2^T; rows are hidden units.
    #[inline]
    pub(super) fn w2_transposed(self, column: usize) -> &'a Panel {
        &self.weights.w2_transposed[self.unit * self.weights.columns + column]
    }

    #[inline]
    pub(super) fn b1(self) -> &'a Block {
        &self.weights.b1[self.unit]
    }

    #[inline]
    pub(super) fn columns(self) -> usize {
        self.weights.columns
    }
}

fn copy_square(matrix: &[f32], columns: usize, [i, j]: [usize; 2], into: &mut Panel) {
    let rows = matrix.chunks_exact(columns).skip(i * BLOCK);
    for (block, row) in into.iter_mut().zip(rows) {
        let row = &row[j * BLOCK..];
        *block = Block::padded(&row[..row.len().min(BLOCK)]);
    }
}
