//! What the forward and the backward kernel share: a scene's rows in lanes, and room for what is computed of them.

#![expect(clippy::inline_always, reason = "the lanes must stay in registers")]

use super::Task;
use crate::kernel::attention::dropout::LaneBits;
use crate::kernel::attention::heads::{GROUP, Part, row_of};
use crate::kernel::attention::lanes::{Block, LANES, Lanes, ZEROS};
use crate::kernel::attention::simd::Simd;

/// Room for one group of heads of a scene, kept from scene to scene.
///
/// Queries lie two by two, a walker in each half of the lanes; keys lie one by one, the same in both halves, so that
/// two queries meet a key in one operation and no sum goes across lanes.
#[derive(Clone, Debug, Default)]
pub(crate) struct Buffers {
    /// By two queries and block of the head's numbers, scaled so that scores are powers of two.
    pub(super) queries: Vec<Block>,
    /// By key and block.
    pub(super) keys: Vec<Block>,
    /// By key and block.
    pub(super) values: Vec<Block>,
    /// By two queries and block: gradient of what they mixed, over the sum of their weights.
    pub(super) mixed_gradients: Vec<Block>,
    /// By two queries and block.
    pub(super) query_gradients: Vec<Block>,
    /// By two queries: largest score, and the mixed values' product with their gradient, over the sum of weights.
    pub(super) inner: Vec<[Lanes; 2]>,
    /// By two queries.
    pub(super) bits: Vec<LaneBits>,
    /// Scores, then weights; by key in the forward pass, by two queries in the backward pass.
    pub(super) weights: Vec<Lanes>,
    /// By two queries, of one key.
    pub(super) score_gradients: Vec<Lanes>,
}

/// What is added to the scores of two queries, by the code of what they see.
pub(super) static UNSEEN: [Lanes; 4] = {
    let mut table = [Lanes([f32::NEG_INFINITY; LANES]); 4];
    let mut lane = 0;
    while lane < LANES {
        table[1 + row_of(lane)].0[lane] = 0.0;
        table[3].0[lane] = 0.0;
        lane += 1;
    }
    table
};

impl Buffers {
    /// Brings queries, keys and values of a group of heads into lanes.
    #[inline(always)]
    pub(super) fn load<S: Simd>(
        &mut self,
        simd: S,
        task: &Task<'_>,
        qkv: &[f32],
        group: usize,
        blocks: usize,
    ) {
        let (row, walkers) = (task.heads.row(), task.scene.walkers);
        let scale = simd.splat(task.heads.scale() * std::f32::consts::LOG2_E);
        self.queries.resize(walkers.div_ceil(2) * blocks, ZEROS);
        self.keys.resize(walkers * blocks, ZEROS);
        self.values.resize(walkers * blocks, ZEROS);
        let twos = qkv.chunks(6 * row);
        for (two, queries) in twos.zip(self.queries.chunks_exact_mut(blocks)) {
            let (first, second) = two.split_at(3 * row);
            let second = second.get(..row);
            for (block, query) in queries.iter_mut().enumerate() {
                let part = Part::new(task.heads, group, block);
                let loaded = part.load(simd, &first[..row], second);
                simd.write(simd.scaled(loaded, scale), query);
            }
        }
        let keys = self.keys.chunks_exact_mut(blocks);
        let keys = keys.zip(self.values.chunks_exact_mut(blocks));
        for (walker, (keys, values)) in qkv.chunks_exact(3 * row).zip(keys) {
            let (key, value) = walker[row..].split_at(row);
            for block in 0..blocks {
                let part = Part::new(task.heads, group, block);
                simd.write(part.load(simd, key, Some(key)), &mut keys[block]);
                simd.write(part.load(simd, value, Some(value)), &mut values[block]);
            }
        }
        self.bits.clear();
        if let Some(decisions) = task.decisions {
            for first in (0..walkers).step_by(2) {
                let of = |walker| decisions.query(task.entry, task.scene.first + walker);
                let two = [of(first), of(first + 1)];
                self.bits.push(LaneBits::new(two, group * GROUP));
            }
        }
    }
}

/// `start` + Σ a b over all blocks.
#[inline(always)]
pub(super) fn dot<S: Simd>(simd: S, a: &[Block], b: &[Block], start: S::Wide) -> S::Wide {
    let mut sum = start;
    for (a, b) in a.iter().zip(b) {
        sum = simd.dot(simd.read(a), simd.read(b), sum);
    }
    sum
}
