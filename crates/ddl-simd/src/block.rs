//! Blocks of 32 numbers, of which matrices are made.

#![expect(clippy::inline_always, reason = "compiled per instruction set")]

use crate::lanes::LANES;

/// Number of `f32` values in a block.
pub const BLOCK: usize = 32;

/// A piece of a row of a matrix. It is aligned, because a load that crosses a cache line costs two loads.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(64))]
pub struct Block(pub [f32; BLOCK]);

/// A matrix of 32 rows and columns.
pub type Panel = [Block; BLOCK];

impl Block {
    /// Zeros.
    pub const ZERO: Self = Self([0.0; BLOCK]);
    /// The matrix of zeros.
    pub const ZERO_PANEL: Panel = [Self::ZERO; BLOCK];

    /// At most 32 numbers, and zeros after them.
    ///
    /// # Panics
    /// If there are more than 32 numbers.
    #[inline(always)]
    pub fn padded(from: &[f32]) -> Self {
        if let Ok(whole) = from.try_into() {
            return Self(whole);
        }
        let mut block = Self::ZERO;
        block.0[..from.len()].copy_from_slice(from);
        block
    }

    /// The sixteen numbers from index 16 `part` on.
    ///
    /// # Panics
    /// If `part` is above 1.
    #[inline(always)]
    pub fn part(&self, part: usize) -> &[f32; LANES] {
        &self.0.as_chunks().0[part]
    }

    /// The sixteen numbers from index 16 `part` on.
    ///
    /// # Panics
    /// If `part` is above 1.
    #[inline(always)]
    pub fn part_mut(&mut self, part: usize) -> &mut [f32; LANES] {
        &mut self.0.as_chunks_mut().0[part]
    }

    /// Adds the numbers to at most 32 sums.
    #[inline(always)]
    pub fn add_to(&self, sums: &mut [f32]) {
        for (sum, term) in sums.iter_mut().zip(&self.0) {
            *sum += term;
        }
    }
}

/// Writes the transposed matrix.
pub fn transpose(panel: &Panel, into: &mut Panel) {
    for (i, row) in into.iter_mut().enumerate() {
        for (j, value) in row.0.iter_mut().enumerate() {
            *value = panel[j].0[i];
        }
    }
}
