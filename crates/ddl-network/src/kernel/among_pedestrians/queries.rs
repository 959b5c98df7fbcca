//! What the forward and the backward kernel share: a scene's rows in lanes, and room for what is computed of them.

use super::dropout::{LaneBits, WeightDecisions};
use crate::kernel::heads::{GROUP, HeadPart, Heads, row_of};
use crate::kernel::scenes::SceneCodes;
use ddl_simd::{LANES, Lanes, Quad, Simd, ZERO_QUAD};

#[derive(Clone, Copy, Debug)]
pub(super) struct SceneTask<'a> {
    pub(super) scene: SceneCodes<'a>,
    pub(super) entry: usize,
    pub(super) decisions: Option<WeightDecisions>,
    pub(super) heads: Heads,
}

impl SceneTask<'_> {
    pub(super) fn normalisers(&self) -> usize {
        self.heads.groups() * self.scene.pedestrians.div_ceil(2)
    }
}

/// Room for one group of heads of a scene, kept from scene to scene.
///
/// Queries lie two by two, a pedestrian in each half of the lanes; keys lie one by one, the same in both halves, so that
/// two queries meet a key in one operation and no sum goes across lanes.
#[derive(Clone, Debug, Default)]
pub(super) struct SceneBuffers {
    /// By two queries and quad of the head's numbers, scaled so that scores are powers of two.
    pub(super) queries: Vec<Quad>,
    pub(super) keys: Vec<Quad>,
    pub(super) values: Vec<Quad>,
    /// By two queries and quad: gradient of what they mixed, over the sum of their weights.
    pub(super) mixed_gradients: Vec<Quad>,
    pub(super) query_gradients: Vec<Quad>,
    /// By two queries: largest score, and the mixed values' product with their gradient, over the sum of weights.
    pub(super) inner: Vec<[Lanes; 2]>,
    pub(super) bits: Vec<LaneBits>,
    /// Scores, then weights; by key in the forward pass, by two queries in the backward pass.
    pub(super) weights: Vec<Lanes>,
    pub(super) score_gradients: Vec<Lanes>,
    pub(super) seen: SeenKeys,
}

/// Scenes with more pedestrians are gone through by who is seen; smaller ones are faster to go through whole.
pub(super) const LARGE: usize = 128;

/// The keys and values that at least one of two queries sees, in the order of the scene.
///
/// Who is not seen has the weight 0: to leave him out changes no bit.
#[derive(Clone, Debug, Default)]
pub(super) struct SeenKeys {
    pub(super) codes: Vec<u8>,
    pub(super) keys: Vec<Quad>,
    pub(super) values: Vec<Quad>,
}

impl SeenKeys {
    pub(super) fn gather(&mut self, codes: &[u8], keys: &[Quad], values: &[Quad], quads: usize) {
        self.codes.clear();
        self.keys.clear();
        self.values.clear();
        let all = keys.chunks_exact(quads).zip(values.chunks_exact(quads));
        for (&code, (key, value)) in codes.iter().zip(all) {
            if code != 0 {
                self.codes.push(code);
                self.keys.extend_from_slice(key);
                self.values.extend_from_slice(value);
            }
        }
    }
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

impl SceneBuffers {
    #[inline(always)]
    pub(super) fn load<S: Simd>(
        &mut self,
        simd: S,
        task: &SceneTask<'_>,
        qkv: &[f32],
        group: usize,
        quads: usize,
    ) {
        let (row, pedestrians) = (task.heads.row(), task.scene.pedestrians);
        let scale = simd.splat(task.heads.scale() * std::f32::consts::LOG2_E);
        self.queries
            .resize(pedestrians.div_ceil(2) * quads, ZERO_QUAD);
        self.keys.resize(pedestrians * quads, ZERO_QUAD);
        self.values.resize(pedestrians * quads, ZERO_QUAD);
        let twos = qkv.chunks(6 * row);
        for (two, queries) in twos.zip(self.queries.chunks_exact_mut(quads)) {
            let (first, second) = two.split_at(3 * row);
            let second = second.get(..row);
            for (quad, query) in queries.iter_mut().enumerate() {
                let part = HeadPart::new(task.heads, group, quad);
                let loaded = part.load(simd, &first[..row], second);
                simd.write(simd.scaled(loaded, scale), query);
            }
        }
        let keys = self.keys.chunks_exact_mut(quads);
        let keys = keys.zip(self.values.chunks_exact_mut(quads));
        for (pedestrian, (keys, values)) in qkv.chunks_exact(3 * row).zip(keys) {
            let (key, value) = pedestrian[row..].split_at(row);
            for quad in 0..quads {
                let part = HeadPart::new(task.heads, group, quad);
                simd.write(part.load(simd, key, Some(key)), &mut keys[quad]);
                simd.write(part.load(simd, value, Some(value)), &mut values[quad]);
            }
        }
        self.bits.clear();
        if let Some(decisions) = task.decisions {
            for first in (0..pedestrians).step_by(2) {
                let of = |pedestrian| decisions.query(task.entry, task.scene.first + pedestrian);
                let two = [of(first), of(first + 1)];
                self.bits.push(LaneBits::new(two, group * GROUP));
            }
        }
    }
}

/// `start` + Σ a b over all quads.
#[inline(always)]
pub(super) fn dot<S: Simd>(simd: S, a: &[Quad], b: &[Quad], start: S::Floats) -> S::Floats {
    let mut sum = start;
    for (a, b) in a.iter().zip(b) {
        sum = simd.dot(simd.read(a), simd.read(b), sum);
    }
    sum
}
