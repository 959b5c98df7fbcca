//! Which attention weights are dropped: a function of (seed, batch entry, query, key, head) alone, of 24 random bits.

#![expect(clippy::inline_always, reason = "the lanes must stay in registers")]

use crate::kernel::dropout::{Dropout, Threshold, mixed};
use crate::kernel::heads::{head_of, row_of};
use ddl_simd::{LANES, Lanes};

/// What the kernels need to know of a [`Dropout`].
#[derive(Clone, Copy, Debug)]
pub(super) struct Decisions {
    seed: u64,
    /// A weight is kept when its 24 bits are this or more.
    least: i32,
    /// 1 / (1 - p).
    scale: f32,
}

impl Decisions {
    /// `None` when nothing is dropped.
    ///
    /// # Panics
    /// Unless 0 <= p < 1.
    pub(super) fn new(dropout: Dropout) -> Option<Self> {
        let Threshold { least, scale } = dropout.threshold(24)?;
        Some(Self {
            // Seeds that follow one another must not give the queries of one another.
            seed: mixed(dropout.seed),
            least: least.cast_signed(),
            scale,
        })
    }

    /// What multiplies a weight: 0 or 1 / (1 - p).
    #[cfg(test)]
    pub(super) fn factor(&self, entry: usize, query: usize, key: usize, head: usize) -> f32 {
        let query = self.query(entry, query);
        self.decide(hash(query, key as u32, head as u32))
    }

    /// Random bits of a query in a batch entry.
    pub(super) fn query(&self, entry: usize, query: usize) -> QueryBits {
        let place = ((entry as u64) << 32) ^ query as u64;
        let bits = mixed(self.seed.wrapping_add(place));
        QueryBits {
            low: bits as u32,
            high: (bits >> 32) as u32,
        }
    }

    /// What multiplies the weights of eight heads each of two queries.
    #[inline(always)]
    pub(super) fn factors(&self, bits: &LaneBits, key: usize) -> Lanes {
        let mut result = Lanes::ZERO;
        for (lane, factor) in result.0.iter_mut().enumerate() {
            let query = QueryBits {
                low: bits.low[lane],
                high: bits.high[lane],
            };
            *factor = self.decide(hash(query, key as u32, bits.head[lane]));
        }
        result
    }

    #[inline(always)]
    fn decide(&self, value: u32) -> f32 {
        // Of 24 bits, so that the comparison may be of signed numbers, which all instruction sets have.
        if (value >> 8).cast_signed() >= self.least {
            self.scale
        } else {
            0.0
        }
    }
}

/// Random bits of a query.
#[derive(Clone, Copy, Debug)]
pub(super) struct QueryBits {
    low: u32,
    high: u32,
}

/// What the decisions of two queries need, lane by lane.
#[derive(Clone, Copy, Debug)]
pub(super) struct LaneBits {
    low: [u32; LANES],
    high: [u32; LANES],
    head: [u32; LANES],
}

impl LaneBits {
    /// Eight heads from `first_head` on of each query.
    pub(super) fn new(queries: [QueryBits; 2], first_head: usize) -> Self {
        let query = |lane: usize| queries[row_of(lane)];
        Self {
            low: std::array::from_fn(|lane| query(lane).low),
            high: std::array::from_fn(|lane| query(lane).high),
            head: std::array::from_fn(|lane| (first_head + head_of(lane)) as u32),
        }
    }
}

/// The finaliser of a multiplicative hash (lowbias32, C. Wellons 2018), a word of the query before and in between.
#[inline(always)]
fn hash(query: QueryBits, key: u32, head: u32) -> u32 {
    let value = (key << 8).wrapping_add(head) ^ query.low;
    let value = (value ^ (value >> 16)).wrapping_mul(0x7feb_352d);
    let value = (value ^ (value >> 15)).wrapping_add(query.high);
    let value = value.wrapping_mul(0x846c_a68b);
    value ^ (value >> 16)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn decisions(p: f64, seed: u64) -> Decisions {
        Decisions::new(Dropout { p, seed }).unwrap()
    }

    /// The share over all, and over each value of each index alone.
    #[test]
    fn drops_the_right_share_everywhere() {
        let p = 0.1;
        let dropout = decisions(p, 7);
        let (entries, pedestrians, heads) = (6, 60, 8);
        let mut shares = vec![(0.0, 0.0); entries + 2 * pedestrians + heads];
        for entry in 0..entries {
            for query in 0..pedestrians {
                for key in 0..pedestrians {
                    for head in 0..heads {
                        let factor = dropout.factor(entry, query, key, head);
                        let dropped = f64::from(u8::from(factor == 0.0));
                        assert!(factor == 0.0 || (factor - 1.0 / 0.9).abs() < 1e-6);
                        let at = [entry, entries + query, entries + pedestrians + key];
                        for index in at.into_iter().chain([entries + 2 * pedestrians + head]) {
                            shares[index].0 += dropped;
                            shares[index].1 += 1.0;
                        }
                    }
                }
            }
        }
        for (index, (dropped, count)) in shares.into_iter().enumerate() {
            let deviation = (p * (1.0 - p) / f64::from(count as u32)).sqrt();
            let share: f64 = dropped / count;
            assert!((share - p).abs() < 4.5 * deviation, "{index}: {share}");
        }
    }

    /// Neighbouring decisions agree as often as independent ones.
    #[test]
    fn neighbours_are_independent() {
        let dropout = decisions(0.5, 3);
        let kept = |at: [usize; 4]| dropout.factor(at[0], at[1], at[2], at[3]) > 0.0;
        for axis in 0..4 {
            let (mut agree, mut count) = (0.0, 0.0);
            for index in 0..40_000 {
                let at = [index % 5, index / 5 % 40, index / 200 % 40, index / 8000];
                let mut next = at;
                next[axis] += 1;
                agree += f64::from(u8::from(kept(at) == kept(next)));
                count += 1.0;
            }
            // standard error 0.0025
            assert!((agree / count - 0.5_f64).abs() < 0.012, "{axis}: {agree}");
        }
    }

    #[test]
    fn seeds_differ_and_nothing_drops_at_zero() {
        let (one, other) = (decisions(0.5, 1), decisions(0.5, 2));
        let differ = (0..1000)
            .filter(|&key| (one.factor(0, 0, key, 0) > 0.0) != (other.factor(0, 0, key, 0) > 0.0));
        assert!((400..600).contains(&differ.count()));
        assert!(Decisions::new(Dropout { p: 0.0, seed: 1 }).is_none());
    }

    #[test]
    #[should_panic(expected = "not in [0, 1)")]
    fn refuses_to_drop_all() {
        let _ = decisions(1.0, 1);
    }
}
