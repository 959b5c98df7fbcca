//! Which hidden activations are dropped: a function of (seed, row, unit) alone, of 16 random bits.

#![expect(clippy::inline_always, reason = "the lanes must stay in registers")]

use super::block::Block;
use super::block_rows::ROWS;
use crate::kernel::dropout::{Dropout, Threshold, mixed};
use crate::kernel::lanes::LANES;
use crate::kernel::simd::Simd;

/// Random numbers of one row, from which those of its units are made.
#[derive(Clone, Copy, Debug)]
pub(super) struct RowKey([u32; 2]);

/// What the kernels need to know of a [`Dropout`].
#[derive(Clone, Debug)]
pub(super) struct Decisions {
    /// An activation is kept when its 16 bits, shifted to the upper half, are this or more.
    least: u32,
    /// 1 / (1 - p).
    pub(super) scale: f32,
    /// Of every row, up to a whole number of tiles.
    rows: Vec<RowKey>,
}

impl Decisions {
    /// Those of the rows 0 .. `rows`; `None` when nothing is dropped.
    ///
    /// # Panics
    /// Unless 0 <= p < 1.
    pub(super) fn new(dropout: Dropout, rows: usize) -> Option<Self> {
        let Threshold { least, scale } = dropout.threshold(16)?;
        // Seeds that follow one another must not give the rows of one another.
        let seed = mixed(dropout.seed);
        let row_key = |row: u64| {
            let bits = mixed(seed.wrapping_add(row));
            RowKey([bits as u32, (bits >> 32) as u32])
        };
        Some(Self {
            least: least << 16,
            scale,
            rows: (0..rows.next_multiple_of(ROWS) as u64)
                .map(row_key)
                .collect(),
        })
    }

    /// Drops and scales the units of block `block` of the rows from `first`.
    ///
    /// A word of 32 bits decides for two units, 16 apart.
    #[inline(always)]
    pub(super) fn apply<S: Simd>(&self, simd: S, rows: &mut [Block], first: usize, block: usize) {
        let scale = simd.splat(self.scale);
        for (row, key) in rows.iter_mut().zip(&self.rows[first..]) {
            let [a, b] = key.0;
            // The finaliser of a multiplicative hash (lowbias32, C. Wellons 2018), the row's second word in between.
            let bits = simd.count_from(a ^ (block * LANES) as u32);
            let bits = simd.mul_low(simd.xor_shift::<16>(bits), 0x7feb_352d);
            let bits = simd.mul_low(simd.xor(simd.xor_shift::<15>(bits), b), 0x846c_a68b);
            let bits = simd.xor_shift::<16>(bits);
            let lower = simd.shift_left::<16>(bits);
            let lower = simd.keep(simd.load(row.part(0)), lower, self.least);
            simd.store(simd.mul(lower, scale), row.part_mut(0));
            let upper = simd.keep(simd.load(row.part(1)), bits, self.least);
            simd.store(simd.mul(upper, scale), row.part_mut(1));
        }
    }
}

#[cfg(test)]
pub(super) mod reference;
#[cfg(test)]
mod tests;
