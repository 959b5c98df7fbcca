//! Blocks of 32 numbers, and rows that consist of them.

use ddl_simd::LANES;
pub(super) use ddl_simd::{BLOCK, Block, Panel};
use std::cell::RefCell;

pub(super) const PARTS: usize = BLOCK / LANES;

#[inline]
pub(super) fn tile<const R: usize>(rows: &[Block], first: usize) -> &[Block; R] {
    rows[first..].first_chunk().expect("rows in whole tiles")
}

#[inline]
pub(super) fn tile_mut<const R: usize>(rows: &mut [Block], first: usize) -> &mut [Block; R] {
    rows[first..].first_chunk_mut().expect("rows in whole tiles")
}

/// The number of rows is padded to a multiple of this, which is a multiple of the rows of each tile of accumulators.
pub(super) const ROWS: usize = 8;

/// Number of free matrices that a thread keeps. Fresh pages would take as long as a tenth of a backward pass.
const SPARE: usize = 32;

thread_local! {
    static SPARES: RefCell<Vec<Vec<Block>>> = const { RefCell::new(Vec::new()) };
}

/// Rows in blocks: first the first block of each row, then the second, and so on.
pub(super) struct BlockRows {
    blocks: Vec<Block>,
    rows: usize,
}

impl BlockRows {
    /// Rows with arbitrary contents.
    pub(super) fn any(rows: usize, columns: usize) -> Self {
        let spare = SPARES.with_borrow_mut(Vec::pop);
        let mut blocks = spare.unwrap_or_default();
        blocks.resize(rows * columns, Block::ZERO);
        Self { blocks, rows }
    }

    pub(super) fn zeros(rows: usize, columns: usize) -> Self {
        let mut result = Self::any(rows, columns);
        result.blocks.fill(Block::ZERO);
        result
    }

    /// Rows of `width` numbers, and rows of zeros up to a multiple of [`ROWS`].
    #[inline(always)]
    pub(super) fn padded(from: &[f32], width: usize) -> Self {
        let count = from.len() / width;
        let mut result = Self::any(count.next_multiple_of(ROWS), width.div_ceil(BLOCK));
        for column in 0..width.div_ceil(BLOCK) {
            let (blocks, padding) = result.column_mut(column).split_at_mut(count);
            for (block, row) in blocks.iter_mut().zip(from.chunks_exact(width)) {
                let piece = &row[column * BLOCK..];
                *block = Block::padded(&piece[..piece.len().min(BLOCK)]);
            }
            padding.fill(Block::ZERO);
        }
        result
    }

    pub(super) fn rows(&self) -> usize {
        self.rows
    }

    pub(super) fn column(&self, column: usize) -> &[Block] {
        &self.blocks[column * self.rows..][..self.rows]
    }

    pub(super) fn column_mut(&mut self, column: usize) -> &mut [Block] {
        &mut self.blocks[column * self.rows..][..self.rows]
    }

    /// Copies rows of `width` numbers to all rows of `into`.
    #[inline(always)]
    pub(super) fn write(&self, into: &mut [f32], width: usize) {
        for (row, into) in into.chunks_exact_mut(width).enumerate() {
            for (column, into) in into.chunks_mut(BLOCK).enumerate() {
                let block = &self.column(column)[row].0;
                match into.as_chunks_mut() {
                    ([whole], []) => *whole = *block,
                    (_, part) => part.copy_from_slice(&block[..part.len()]),
                }
            }
        }
    }

    /// Adds rows from `first` on to all rows of `sums`.
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
        // When a thread ends, its free memory may already be dropped.
        let _ = SPARES.try_with(|spares| {
            let mut spares = spares.borrow_mut();
            if spares.len() < SPARE {
                spares.push(blocks);
            }
        });
    }
}
