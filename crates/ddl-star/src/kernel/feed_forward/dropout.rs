//! Dropout (Srivastava et al. 2014) whose decisions are a function of a seed and a place, not of the order of work.

#![expect(clippy::inline_always, reason = "the lanes must stay in registers")]

use super::Block;
use super::simd::{LANES, ROWS, Simd};

/// Sets each hidden activation to 0 with probability `p` and scales the others by 1 / (1 - p).
///
/// The decision for a unit of a row is a function of (`seed`, row, unit) alone: the same in the forward and the backward
/// pass, on every machine, for every number of threads. Each layer of each step needs a seed of its own.
///
/// # Numerics
/// 16 random bits a decision: p is rounded to a multiple of 1/65536, at most 65535/65536.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dropout {
    /// Probability that an activation is dropped, 0 <= p < 1.
    pub p: f64,
    /// Which of 2^64 sets of decisions.
    pub seed: u64,
}

/// Random numbers of one row, from which those of its units are made.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RowKey([u32; 2]);

/// What the kernels need to know of a [`Dropout`].
#[derive(Clone, Debug)]
pub(crate) struct Decisions {
    /// An activation is kept when its 16 bits, shifted to the upper half, are this or more.
    least: u32,
    /// 1 / (1 - p).
    pub(crate) scale: f32,
    /// Of every row, up to a whole number of tiles.
    rows: Vec<RowKey>,
}

impl Decisions {
    /// Those of the rows 0 .. `rows`; `None` when nothing is dropped.
    ///
    /// # Panics
    /// Unless 0 <= p < 1.
    pub(crate) fn new(dropout: Dropout, rows: usize) -> Option<Self> {
        let Dropout { p, seed } = dropout;
        assert!((0.0..1.0).contains(&p), "dropout of {p}: not in [0, 1)");
        let dropped = (p * 65_536.0).round().min(65_535.0);
        // Seeds that follow one another must not give the rows of one another.
        let seed = mixed(seed);
        let row_key = |row: u64| {
            let bits = mixed(seed.wrapping_add(row));
            RowKey([bits as u32, (bits >> 32) as u32])
        };
        (dropped > 0.0).then(|| Self {
            least: (dropped as u32) << 16,
            scale: (65_536.0 / (65_536.0 - dropped)) as f32,
            rows: (0..rows.next_multiple_of(ROWS) as u64)
                .map(row_key)
                .collect(),
        })
    }

    /// Drops and scales the units of block `block` of the rows from `first`.
    ///
    /// A word of 32 bits decides for two units, 16 apart.
    #[inline(always)]
    pub(crate) fn apply<S: Simd>(&self, simd: S, rows: &mut [Block], first: usize, block: usize) {
        let half = LANES / S::WIDTH;
        let scale = simd.splat(self.scale);
        for (row, key) in rows.iter_mut().zip(&self.rows[first..]) {
            let [a, b] = key.0;
            for part in 0..half {
                // The finaliser of a multiplicative hash (lowbias32, C. Wellons 2018), the row's second word in between.
                let bits = simd.count_from(a ^ (block * LANES) as u32, part);
                let bits = simd.mul_low(simd.xor_shift::<16>(bits), 0x7feb_352d);
                let bits = simd.mul_low(simd.xor(simd.xor_shift::<15>(bits), b), 0x846c_a68b);
                let bits = simd.xor_shift::<16>(bits);
                let lower = simd.keep(
                    simd.load(row, part),
                    simd.shift_left::<16>(bits),
                    self.least,
                );
                simd.store(simd.mul(lower, scale), row, part);
                let upper = simd.keep(simd.load(row, part + half), bits, self.least);
                simd.store(simd.mul(upper, scale), row, part + half);
            }
        }
    }
}

/// The finaliser of `SplitMix64` (Steele et al. 2014) after a step of its counter.
fn mixed(word: u64) -> u64 {
    let word = word
        .wrapping_mul(0x9e37_79b9_7f4a_7c15)
        .wrapping_add(0x9e37_79b9_7f4a_7c15);
    let word = (word ^ (word >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let word = (word ^ (word >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    word ^ (word >> 31)
}

#[cfg(test)]
pub(crate) mod reference;
#[cfg(test)]
mod tests;
