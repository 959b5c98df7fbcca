//! What the forward and the backward kernel share: a scene's rows in lanes, and room for what is computed of them.

#![expect(clippy::inline_always, reason = "the lanes must stay in registers")]

use super::Task;
use crate::kernel::attention::dropout::LaneBits;
use crate::kernel::attention::heads::{GROUP, Part};
use crate::kernel::attention::lanes::{LANES, Lanes, Vectors, scaled};

/// Room for one group of heads of a scene, kept from scene to scene.
///
/// Queries lie two by two, a walker in each half of the lanes; keys lie one by one, the same in both halves, so that
/// two queries meet a key in one operation and no sum goes across lanes.
#[derive(Clone, Debug, Default)]
pub(crate) struct Buffers {
    /// By two queries and block of the head's numbers, scaled so that scores are powers of two.
    pub(super) queries: Vec<Vectors>,
    /// By key and block.
    pub(super) keys: Vec<Vectors>,
    /// By key and block.
    pub(super) values: Vec<Vectors>,
    /// By two queries and block: gradient of what they mixed, over the sum of their weights.
    pub(super) mixed_gradients: Vec<Vectors>,
    /// By two queries and block.
    pub(super) query_gradients: Vec<Vectors>,
    /// By two queries: largest score, and the gradient of the logarithm of the sum of weights, over the sum.
    pub(super) normalisers: Vec<[Lanes; 2]>,
    /// By two queries.
    pub(super) bits: Vec<LaneBits>,
    /// Scores, then weights; by key in the forward pass, by two queries in the backward pass.
    pub(super) weights: Vec<Lanes>,
    /// By two queries, of one key.
    pub(super) score_gradients: Vec<Lanes>,
}

/// What is added to the scores of two queries, by the code of what they see.
pub(super) static UNSEEN: [Lanes; 4] = {
    let (none, seen) = (f32::NEG_INFINITY, 0.0);
    let mut table = [Lanes::splat(none); 4];
    let mut lane = 0;
    while lane < LANES {
        table[1 + lane / GROUP].0[lane] = seen;
        table[3].0[lane] = seen;
        lane += 1;
    }
    table
};

impl Buffers {
    /// Brings queries, keys and values of a group of heads into lanes.
    #[inline(always)]
    pub(super) fn load(&mut self, task: &Task<'_>, qkv: &[f32], group: usize, blocks: usize) {
        let row = task.heads.row();
        let scale = Lanes::splat(task.heads.scale() * std::f32::consts::LOG2_E);
        self.queries.clear();
        self.keys.clear();
        self.values.clear();
        for two in qkv.chunks(6 * row) {
            let (first, second) = two.split_at(3 * row);
            let second = (!second.is_empty()).then_some(second);
            for block in 0..blocks {
                let part = Part::new(task.heads, group, block);
                let query = part.load(&first[..row], second.map(|second| &second[..row]));
                self.queries.push(scaled(&query, scale));
            }
        }
        for walker in qkv.chunks_exact(3 * row) {
            let (key, value) = walker[row..].split_at(row);
            for block in 0..blocks {
                let part = Part::new(task.heads, group, block);
                self.keys.push(part.load(key, Some(key)));
                self.values.push(part.load(value, Some(value)));
            }
        }
        self.bits.clear();
        if let Some(decisions) = task.decisions {
            for first in (0..task.scene.walkers).step_by(2) {
                let of = |walker| decisions.query(task.entry, task.scene.first + walker);
                let two = [of(first), of(first + 1)];
                self.bits.push(LaneBits::new(two, group * GROUP));
            }
        }
    }
}
