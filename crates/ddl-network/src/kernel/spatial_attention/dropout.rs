//! Dropout of attention weights: a function of only (seed, batch entry, query, key, head), with 24 random bits.

use crate::kernel::dropout::{Dropout, RowKey, Threshold, mixed};
use crate::kernel::heads::{head_of, row_of};
use ddl_simd::{LANES, Lanes};

#[derive(Clone, Copy, Debug)]
pub(super) struct WeightDecisions {
    seed: u64,
    /// A weight is kept if its 24 bits are at least this.
    least: i32,
    /// 1 / (1 - p).
    scale: f32,
}

impl WeightDecisions {
    /// `None` if nothing is dropped.
    pub(super) fn new(dropout: Dropout) -> Option<Self> {
        let Threshold { least, scale } = dropout.threshold(24)?;
        Some(Self {
            // Consecutive seeds must not give the same bits to shifted queries.
            seed: mixed(dropout.seed),
            least: least.cast_signed(),
            scale,
        })
    }

    /// The factor of a weight: 0 or 1 / (1 - p).
    #[cfg(test)]
    pub(super) fn factor(&self, entry: usize, query: usize, key: usize, head: usize) -> f32 {
        self.decide(hash(self.query(entry, query), key as u32, head as u32))
    }

    pub(super) fn query(&self, entry: usize, query: usize) -> RowKey {
        RowKey::new(self.seed, ((entry as u64) << 32) ^ query as u64)
    }

    #[inline(always)]
    pub(super) fn factors(&self, bits: &LaneBits, key: usize) -> Lanes {
        let mut result = Lanes::ZERO;
        for (lane, factor) in result.0.iter_mut().enumerate() {
            let query = RowKey([bits.low[lane], bits.high[lane]]);
            *factor = self.decide(hash(query, key as u32, bits.head[lane]));
        }
        result
    }

    #[inline(always)]
    fn decide(&self, value: u32) -> f32 {
        // 24 bits are never negative, so a signed comparison is correct; all instruction sets have one.
        if (value >> 8).cast_signed() >= self.least { self.scale } else { 0.0 }
    }
}

#[derive(Clone, Copy, Debug)]
pub(super) struct LaneBits {
    low: [u32; LANES],
    high: [u32; LANES],
    head: [u32; LANES],
}

impl LaneBits {
    pub(super) fn new(queries: [RowKey; 2], first_head: usize) -> Self {
        let query = |lane: usize| queries[row_of(lane)];
        Self {
            low: std::array::from_fn(|lane| query(lane).0[0]),
            high: std::array::from_fn(|lane| query(lane).0[1]),
            head: std::array::from_fn(|lane| (first_head + head_of(lane)) as u32),
        }
    }
}

/// The finaliser of a multiplicative hash (lowbias32, C. Wellons 2018), with one word of the query mixed in before it
/// and another in its middle.
#[inline(always)]
fn hash(RowKey([low, high]): RowKey, key: u32, head: u32) -> u32 {
    let value = (key << 8).wrapping_add(head) ^ low;
    let value = (value ^ (value >> 16)).wrapping_mul(0x7feb_352d);
    let value = (value ^ (value >> 15)).wrapping_add(high).wrapping_mul(0x846c_a68b);
    value ^ (value >> 16)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernel::tests::chance::Decided;

    /// Decisions with entries and queries in rows, keys and heads in columns.
    fn decided(p: f64, seed: u64) -> Decided {
        let (pedestrians, heads) = (60, 8);
        let decisions = WeightDecisions::new(Dropout { p, seed }).unwrap();
        Decided::new(p, [6 * pedestrians, pedestrians * heads], |row, column| {
            let (entry, query) = (row / pedestrians, row % pedestrians);
            decisions.factor(entry, query, column / heads, column % heads) == 0.0
        })
    }

    #[test]
    fn decisions_are_like_chance_and_seeds_decide_apart() {
        for p in [0.1, 0.5] {
            decided(p, 7).assert_like_chance();
        }
        let first = decided(0.1, 1);
        for seed in [0, 2, 1 + (1 << 32)] {
            first.assert_apart_from(&format!("seed {seed}"), &decided(0.1, seed));
        }
    }
}
