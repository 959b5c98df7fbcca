//! Thirty-two numbers, the unit that matrices are cut into.

use ddl_simd::LANES;

/// Numbers in a [`Block`].
pub(super) const BLOCK: usize = 32;

/// Times sixteen numbers in a [`Block`].
pub(super) const PARTS: usize = BLOCK / LANES;

/// A piece of a row of a matrix. Aligned, because a register's load that crosses a cache line costs two.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(super) struct Block(pub(super) [f32; BLOCK]);

impl Block {
    pub(super) const ZERO: Self = Self([0.0; BLOCK]);

    /// Up to 32 numbers, the others 0.
    pub(super) fn padded(from: &[f32]) -> Self {
        if let Some(whole) = from.first_chunk() {
            return Self(*whole);
        }
        let mut block = Self::ZERO;
        block.0[..from.len()].copy_from_slice(from);
        block
    }

    /// The sixteen numbers from 16 `part` on.
    #[inline(always)]
    pub(super) fn part(&self, part: usize) -> &[f32; LANES] {
        &self.0.as_chunks().0[part]
    }

    #[inline(always)]
    pub(super) fn part_mut(&mut self, part: usize) -> &mut [f32; LANES] {
        &mut self.0.as_chunks_mut().0[part]
    }

    /// Adds as many of the numbers as there are sums.
    #[inline(always)]
    pub(super) fn add_to(&self, sums: &mut [f32]) {
        for (sum, term) in sums.iter_mut().zip(&self.0) {
            *sum += term;
        }
    }
}

/// 32 rows of a block each.
pub(super) type Panel = [Block; BLOCK];

/// Writes the transposed panel.
pub(super) fn transpose(panel: &Panel, into: &mut Panel) {
    for (i, row) in into.iter_mut().enumerate() {
        for (j, value) in row.0.iter_mut().enumerate() {
            *value = panel[j].0[i];
        }
    }
}

/// R rows from `first`.
#[inline]
pub(super) fn tile<const R: usize>(rows: &[Block], first: usize) -> &[Block; R] {
    rows[first..].first_chunk().expect("rows in whole tiles")
}

#[inline]
pub(super) fn tile_mut<const R: usize>(rows: &mut [Block], first: usize) -> &mut [Block; R] {
    rows[first..]
        .first_chunk_mut()
        .expect("rows in whole tiles")
}
