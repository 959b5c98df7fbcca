//! Dropout (Srivastava et al. 2014). A decision is a function of the seed and of the number's index, not of the order
//! of the work.

use ddl_simd::Simd;
use fearless_simd::u32x16;

/// Sets each number to 0 with probability `p` and scales the others by 1 / (1 - p).
///
/// The decision is a function of only `seed` and the index of the number, so each layer of each step needs its own
/// seed. p is rounded to less than 1: to a multiple of 2^-16 for hidden units, of 2^-24 for attention weights and
/// outputs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Dropout {
    /// Probability that a number is dropped, 0 <= p < 1.
    pub(crate) p: f64,
    /// Selects one of 2^64 sets of decisions.
    pub(crate) seed: u64,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Threshold {
    /// A number is kept if its random bits are at least this.
    pub(super) least: u32,
    /// 1 / (1 - p).
    pub(super) scale: f32,
}

impl Dropout {
    /// The threshold for `bits` random bits, at most 24; `None` if nothing is dropped.
    pub(super) fn threshold(self, bits: u32) -> Option<Threshold> {
        let p = self.p;
        assert!((0.0..1.0).contains(&p), "dropout of {p}: not in [0, 1)");
        let values = f64::from(1_u32 << bits);
        let dropped = (p * values).round().min(values - 1.0);
        (dropped > 0.0).then(|| Threshold { least: dropped as u32, scale: (values / (values - dropped)) as f32 })
    }
}

/// Random bits of a row, from which those of its numbers are made.
#[derive(Clone, Copy, Debug)]
pub(super) struct RowKey(pub(super) [u32; 2]);

impl RowKey {
    /// The key of a row, for a seed from [`mixed`].
    #[inline]
    pub(super) fn new(seed: u64, row: u64) -> Self {
        let bits = mixed(seed.wrapping_add(row));
        Self([bits as u32, (bits >> 32) as u32])
    }

    /// 32 random bits for each of the sixteen numbers from `first`, a multiple of 16.
    #[inline(always)]
    pub(super) fn bits<S: Simd>(self, simd: S, first: usize) -> u32x16<S> {
        let [a, b] = self.0;
        // The finaliser of a multiplicative hash (lowbias32, C. Wellons 2018), with the row's second word in the
        // middle.
        let bits = simd.count_from(a ^ first as u32);
        let bits = (bits ^ (bits >> 16)) * 0x7feb_352d;
        let bits = (bits ^ (bits >> 15) ^ b) * 0x846c_a68b;
        bits ^ (bits >> 16)
    }
}

/// The finaliser of `SplitMix64` (Steele et al. 2014) after a step of its counter.
pub(super) fn mixed(word: u64) -> u64 {
    let word = word.wrapping_mul(0x9e37_79b9_7f4a_7c15).wrapping_add(0x9e37_79b9_7f4a_7c15);
    let word = (word ^ (word >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let word = (word ^ (word >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    word ^ (word >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernel::tests::numbers::assert_refused;

    fn threshold(p: f64, bits: u32) -> Option<(u32, f32)> {
        let threshold = Dropout { p, seed: 0 }.threshold(bits);
        threshold.map(|threshold| (threshold.least, threshold.scale))
    }

    #[test]
    fn probabilities_are_rounded_to_what_the_bits_can_say() {
        assert_eq!(threshold(0.0, 16), None);
        assert_eq!(threshold(0.49 / 65_536.0, 16), None);
        assert_eq!(threshold(0.25, 16), Some((16_384, 4.0 / 3.0)));
        assert_eq!(threshold(0.25, 24), Some((4_194_304, 4.0 / 3.0)));
        assert_eq!(threshold(1.0 - 1e-12, 16), Some((65_535, 65_536.0)));
        for p in [f64::NAN, 1.0, -0.1] {
            assert_refused("not in [0, 1)", || assert_eq!(threshold(p, 24), None));
        }
    }

    #[test]
    fn words_are_mixed_as_published() {
        // The first two numbers of SplitMix64 from the seed 0.
        assert_eq!(mixed(0), 0xe220_a839_7b1d_cdaf);
        assert_eq!(mixed(1), 0x6e78_9e6a_a1b9_65f4);
    }
}
