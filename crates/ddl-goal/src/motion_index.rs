//! Exact nearest-neighbour search over the motions of a library and their mirror images.

#![expect(clippy::inline_always, reason = "compiled per instruction set")]

use crate::expert::Expert;
use crate::motion::{COMPONENTS, SIGNED};
use ddl_simd::{Dispatch, Kernel, Simd};

/// Tracks compared at once, so that the loop over them is vectorised.
const LANES: usize = 16;

type Block = [[f32; LANES]; COMPONENTS];

#[derive(Clone, Debug)]
pub(crate) struct MotionIndex {
    blocks: Vec<Block>,
    len: usize,
}

impl MotionIndex {
    pub(crate) fn new(motions: &[[f32; COMPONENTS]]) -> Self {
        let block = |motions: &[[f32; COMPONENTS]]| {
            // Lanes without a track are infinitely far from every query.
            let mut block = [[f32::INFINITY; LANES]; COMPONENTS];
            for (lane, motion) in motions.iter().enumerate() {
                for (components, &component) in block.iter_mut().zip(motion) {
                    components[lane] = component;
                }
            }
            block
        };
        Self { blocks: motions.chunks(LANES).map(block).collect(), len: motions.len() }
    }

    /// The `wanted` nearest of the tracks and their mirror images (all if there are fewer), nearest first; ties by
    /// index, a track before its image.
    pub(crate) fn nearest(&self, query: &[f32; COMPONENTS], wanted: usize) -> Vec<Expert> {
        let wanted = wanted.min(2 * self.len);
        if wanted == 0 {
            return Vec::new();
        }
        let mut keys = Vec::new();
        Dispatch::detect().run(NearestMotions { blocks: &self.blocks, query, wanted, keys: &mut keys });
        keys.sort_unstable();
        keys.truncate(wanted);
        keys.iter().map(|&key| expert(key)).collect()
    }
}

/// The keys of the nearest tracks, and of some others.
struct NearestMotions<'a> {
    blocks: &'a [Block],
    query: &'a [f32; COMPONENTS],
    wanted: usize,
    keys: &'a mut Vec<u64>,
}

impl Kernel for NearestMotions<'_> {
    /// Plain loops, compiled for the instruction set; the result has the same bits for every instruction set.
    #[inline(always)]
    fn run<S: Simd>(self, _: S) {
        // Room for the keys that one block adds before the nearest are selected.
        let mut keys = vec![0; 2 * (self.wanted + LANES)];
        let mut count = 0;
        let mut bound = f32::INFINITY;
        for (first, block) in (0..).step_by(LANES).zip(self.blocks) {
            let both = distances(self.query, block);
            for (mirrored, distances) in both.iter().enumerate() {
                // Without an early exit the minimum takes a few vector instructions.
                let least = |least, &d| if d < least { d } else { least };
                if distances.iter().fold(f32::INFINITY, least) < bound {
                    // Each key is written, and kept if it is near enough: this avoids an unpredictable branch.
                    for (lane, &distance) in distances.iter().enumerate() {
                        keys[count] = key(distance, 2 * (first + lane) + mirrored);
                        count += usize::from(distance < bound);
                    }
                }
            }
            if count >= 2 * self.wanted {
                let (_, &mut last, _) = keys[..count].select_nth_unstable(self.wanted - 1);
                count = self.wanted;
                bound = distance_of(last);
            }
        }
        keys.truncate(count);
        *self.keys = keys;
    }
}

/// Squared distances of a query to sixteen tracks and to their mirror images.
#[inline(always)]
fn distances(query: &[f32; COMPONENTS], block: &Block) -> [[f32; LANES]; 2] {
    let (same, signed) = query.split_at(SIGNED);
    let (blocks_same, blocks_signed) = block.split_at(SIGNED);
    let mut plain = [0.0; LANES];
    for (&query, track) in same.iter().zip(blocks_same) {
        for lane in 0..LANES {
            let difference = query - track[lane];
            plain[lane] += difference * difference;
        }
    }
    let mut image = plain;
    for (&query, track) in signed.iter().zip(blocks_signed) {
        for lane in 0..LANES {
            let (difference, sum) = (query - track[lane], query + track[lane]);
            plain[lane] += difference * difference;
            image[lane] += sum * sum;
        }
    }
    [plain, image]
}

/// Distance and number in one integer that sorts by distance, then number. The bits of floats that are not negative
/// have the same order as the floats. 2³¹ tracks would take 700 GB.
fn key(distance: f32, number: usize) -> u64 {
    (u64::from(distance.to_bits()) << 32) + number as u64
}

fn distance_of(key: u64) -> f32 {
    f32::from_bits((key >> 32) as u32)
}

fn expert(key: u64) -> Expert {
    let number = key as u32 as usize;
    Expert { index: number / 2, mirrored: number % 2 == 1, distance: distance_of(key).into() }
}

#[cfg(test)]
mod tests {
    use super::{COMPONENTS, Expert, MotionIndex, SIGNED};
    use proptest::prelude::*;

    fn motion() -> impl Strategy<Value = [f32; COMPONENTS]> {
        // Occasionally coarse numbers: equal motions and ties.
        let coarse = prop::array::uniform16((-2..3_i32).prop_map(|v| v as f32 / 2.0));
        prop_oneof![coarse, prop::array::uniform16(-3.0..3.0_f32)]
    }

    fn sorted(motions: &[[f32; COMPONENTS]], query: &[f32; COMPONENTS]) -> Vec<Expert> {
        let mut candidates = Vec::new();
        for (index, motion) in motions.iter().enumerate() {
            for mirrored in [false, true] {
                let sign = if mirrored { -1.0 } else { 1.0 };
                let squares = query.iter().zip(motion).enumerate();
                let distance = squares.fold(0.0_f32, |sum, (i, (q, m))| {
                    let m = if i < SIGNED { *m } else { sign * m };
                    sum + (q - m) * (q - m)
                });
                candidates.push(Expert { index, mirrored, distance: distance.into() });
            }
        }
        candidates.sort_by(|a, b| a.distance.total_cmp(&b.distance)); // stable: ties keep their order
        candidates
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

        #[test]
        fn the_nearest_are_those_of_a_full_sort(
            motions in prop::collection::vec(motion(), 1..200), query in motion(), wanted in 0..450_usize,
        ) {
            let mut expected = sorted(&motions, &query);
            expected.truncate(wanted);
            prop_assert_eq!(MotionIndex::new(&motions).nearest(&query, wanted), expected);
        }
    }
}
