//! Blocks of 32 numbers, and rows that consist of them.

use ddl_simd::LANES;
use std::cell::RefCell;

pub(super) const BLOCK: usize = 32;

pub(super) const PARTS: usize = BLOCK / LANES;

/// A piece of a row of a matrix. It is aligned, because a load that crosses a cache line costs two loads.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(super) struct Block(pub(super) [f32; BLOCK]);

impl Block {
    pub(super) const ZERO: Self = Self([0.0; BLOCK]);

    #[inline(always)]
    pub(super) fn padded(from: &[f32]) -> Self {
        if let Some(whole) = from.first_chunk() {
            return Self(*whole);
        }
        let mut block = Self::ZERO;
        block.0[..from.len()].copy_from_slice(from);
        block
    }

    /// The sixteen numbers from index 16 `part` on.
    #[inline(always)]
    pub(super) fn part(&self, part: usize) -> &[f32; LANES] {
        &self.0.as_chunks().0[part]
    }

    #[inline(always)]
    pub(super) fn part_mut(&mut self, part: usize) -> &mut [f32; LANES] {
        &mut self.0.as_chunks_mut().0[part]
    }

    #[inline(always)]
    pub(super) fn add_to(&self, sums: &mut [f32]) {
        for (sum, term) in sums.iter_mut().zip(&self.0) {
            *sum += term;
        }
    }
}

pub(super) type Panel = [Block; BLOCK];

pub(super) fn transpose(panel: &Panel, into: &mut Panel) {
    for (i, row) in into.iter_mut().enumerate() {
        for (j, value) in row.0.iter_mut().enumerate() {
            *value = panel[j].0[i];
        }
    }
}

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
