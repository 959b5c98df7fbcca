//! Dropout before the residual connection.

use crate::kernel::dropout::{Dropout, RowKey, Threshold, mixed};
use ddl_simd::Simd;

/// Which numbers of t are dropped: a function of (seed, row, column) alone, of 24 random bits.
#[derive(Clone, Copy, Debug)]
pub(in crate::kernel) struct Decisions {
    seed: u64,
    least: u32,
    scale: f32,
}

impl Decisions {
    /// `None` when nothing is dropped.
    pub(in crate::kernel) fn new(dropout: Dropout) -> Option<Self> {
        let Threshold { least, scale } = dropout.threshold(24)?;
        Some(Self {
            seed: mixed(dropout.seed),
            least: least << 8,
            scale,
        })
    }

    /// Sixteen numbers of a row from `at`, some of which are dropped.
    #[inline(always)]
    pub(super) fn apply<S: Simd>(
        self,
        simd: S,
        numbers: S::Floats,
        row: usize,
        at: usize,
    ) -> S::Floats {
        let bits = RowKey::new(self.seed, row as u64).bits(simd, at);
        simd.mul(simd.keep(numbers, bits, self.least), simd.splat(self.scale))
    }
}
