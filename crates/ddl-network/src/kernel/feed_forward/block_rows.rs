//! Rows of a matrix, cut into blocks.

use std::cell::RefCell;

use super::block::{BLOCK, Block};

/// Rows are padded to a multiple of this, which every tile of accumulators divides.
pub(super) const ROWS: usize = 8;

/// Memory that a thread keeps for the next matrices: to ask the system for it, and to be given it a page at a time, would
/// take as long as a tenth of a backward pass.
const SPARE: usize = 32;

thread_local! {
    static SPARES: RefCell<Vec<Vec<Block>>> = const { RefCell::new(Vec::new()) };
}

/// All first blocks of the rows, then all second ones, and so on.
pub(super) struct BlockRows {
    blocks: Vec<Block>,
    rows: usize,
}

impl BlockRows {
    /// Zeros: `rows` rows of `columns` blocks.
    pub(super) fn zeros(rows: usize, columns: usize) -> Self {
        let spare = SPARES.with_borrow_mut(Vec::pop);
        let mut blocks = spare.unwrap_or_default();
        blocks.clear();
        blocks.resize(rows * columns, Block::ZERO);
        Self { blocks, rows }
    }

    /// Rows of `width` numbers, followed by rows of zeros until there are a multiple of [`ROWS`].
    pub(super) fn padded(from: &[f32], width: usize) -> Self {
        let rows = (from.len() / width).next_multiple_of(ROWS);
        let mut result = Self::zeros(rows, width.div_ceil(BLOCK));
        for (r, row) in from.chunks_exact(width).enumerate() {
            for (c, piece) in row.chunks(BLOCK).enumerate() {
                result.column_mut(c)[r] = Block::padded(piece);
            }
        }
        result
    }

    pub(super) fn rows(&self) -> usize {
        self.rows
    }

    /// The `column`-th block of every row.
    pub(super) fn column(&self, column: usize) -> &[Block] {
        &self.blocks[column * self.rows..][..self.rows]
    }

    pub(super) fn column_mut(&mut self, column: usize) -> &mut [Block] {
        &mut self.blocks[column * self.rows..][..self.rows]
    }

    /// Adds the rows from `first` to those of `sums`, as many as these are.
    pub(super) fn add_to(&self, first: usize, sums: &mut [f32], width: usize) {
        for (row, sums) in (first..).zip(sums.chunks_exact_mut(width)) {
            for (column, sums) in sums.chunks_mut(BLOCK).enumerate() {
                self.column(column)[row].add_to(sums);
            }
        }
    }
}

impl Drop for BlockRows {
    fn drop(&mut self) {
        let blocks = std::mem::take(&mut self.blocks);
        // At the end of a thread there is no place to keep it any more.
        let _ = SPARES.try_with(|spares| {
            let mut spares = spares.borrow_mut();
            if spares.len() < SPARE {
                spares.push(blocks);
            }
        });
    }
}
