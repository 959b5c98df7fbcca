//! Dropout of hidden activations: a function of only (seed, row, unit), with 16 random bits.

use crate::kernel::dropout::{Dropout, RowKey, Threshold, mixed};
use crate::kernel::product::BLOCK;
use ddl_simd::{LANES, Simd};

#[derive(Clone, Debug)]
pub(super) struct UnitDecisions {
    /// An activation is kept if its 16 bits, shifted to the upper half, are at least this.
    least: u32,
    /// 1 / (1 - p).
    pub(super) scale: f32,
    /// Keys of all rows.
    rows: Vec<RowKey>,
}

impl UnitDecisions {
    /// The decisions for the rows 0 .. `rows`; `None` if nothing is dropped.
    pub(super) fn new(dropout: Dropout, rows: usize) -> Option<Self> {
        let Threshold { least, scale } = dropout.threshold(16)?;
        // Consecutive seeds must not give the same bits to shifted rows.
        let seed = mixed(dropout.seed);
        Some(Self { least: least << 16, scale, rows: (0..rows as u64).map(|row| RowKey::new(seed, row)).collect() })
    }

    /// Drops and scales the units of block `block` of the rows from `first`; `hidden` `[rows, 32]`.
    ///
    /// A word of 32 bits decides for two units, 16 apart.
    #[inline(always)]
    pub(super) fn apply<S: Simd>(&self, simd: S, hidden: &mut [f32], first: usize, block: usize) {
        let scale = simd.splat(self.scale);
        let rows = hidden.as_chunks_mut::<BLOCK>().0;
        for (row, key) in rows.iter_mut().zip(&self.rows[first..]) {
            let bits = key.bits(simd, block * LANES);
            let (halves, _) = row.as_chunks_mut();
            let lower = bits << 16;
            let lower = simd.keep(simd.load(&halves[0]), lower, self.least);
            simd.store(lower * scale, &mut halves[0]);
            let upper = simd.keep(simd.load(&halves[1]), bits, self.least);
            simd.store(upper * scale, &mut halves[1]);
        }
    }
}

#[cfg(test)]
pub(super) mod reference;
