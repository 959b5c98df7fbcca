//! Shared parts of the forward and the backward kernel: a scene's rows in lanes, and buffers.

use crate::kernel::heads::{self, GROUP, Heads, row_of};
use crate::kernel::quads::{HalfQuad, Quad, Quads as _, ZERO_QUAD};
use crate::kernel::scenes::SceneView;
use crate::kernel::spatial_attention::dropout::{LaneBits, WeightDecisions};
use crate::kernel::threads::run_jobs;
use ddl_simd::{Dispatch, Kernel, LANES, Lanes, Simd};
use std::cell::RefCell;
use std::ops::Range;

/// A block of queries of a scene and the keys that they read.
#[derive(Clone, Debug)]
pub(super) struct SceneTask<'a> {
    pub(super) scene: SceneView<'a>,
    /// The pairs of queries.
    pub(super) twos: Range<usize>,
    /// A range of pedestrians of the scene that contains all keys visible to the queries.
    pub(super) keys: Range<usize>,
    pub(super) entry: usize,
    pub(super) decisions: Option<WeightDecisions>,
    pub(super) heads: Heads,
}

impl SceneTask<'_> {
    /// Indices, in the scene, of the queries' pedestrians.
    pub(super) fn queries(&self) -> Range<usize> {
        2 * self.twos.start..self.scene.pedestrians.min(2 * self.twos.end)
    }

    /// The task split into blocks of queries. If pedestrians are sorted by position, a block reads few keys.
    pub(super) fn blocks(self) -> impl Iterator<Item = Self> {
        let Range { start, end } = self.twos;
        (start..end).step_by(TWOS_AT_ONCE).map(move |first| {
            let twos = first..end.min(first + TWOS_AT_ONCE);
            let lists = twos.clone().map(|two| self.scene.keys_of(two));
            let ends = lists.map(|seen| [seen[0].key(), seen[seen.len() - 1].key()]);
            let range = ends.reduce(|[a, b], [c, d]| [a.min(c), b.max(d)]);
            let [first, last] = range.unwrap_or_default();
            Self { twos, keys: first..last + 1, ..self.clone() }
        })
    }
}

/// Pairs of queries in a block. It is small enough for the cache, and large enough to share the loaded keys.
pub(super) const TWOS_AT_ONCE: usize = 256;

/// Buffers for one group of heads of a task, reused by the next task.
///
/// A vector holds two queries, one in each half of the lanes, or one key in both halves; the key is stored once. So one
/// operation combines two queries with a key, and there are no sums across lanes.
#[derive(Clone, Debug, Default)]
pub(super) struct SceneBuffers {
    /// For each pair of queries; scaled so that scores are exponents of two.
    pub(super) queries: Vec<Quad>,
    pub(super) keys: Vec<HalfQuad>,
    pub(super) values: Vec<HalfQuad>,
    /// For each pair of queries: gradient of the mixed values, over the sum of the weights.
    pub(super) mixed_gradients: Vec<Quad>,
    pub(super) query_gradients: Vec<Quad>,
    /// For each pair of queries: largest score, and the product of mixed values and their gradient, over the sum of the
    /// weights.
    pub(super) inner: Vec<[Lanes; 2]>,
    pub(super) bits: Vec<LaneBits>,
    /// Scores, then weights: for each key in the forward pass, for each pair of queries in the backward pass.
    pub(super) weights: Vec<Lanes>,
    pub(super) score_gradients: Vec<Lanes>,
    /// For each pair of queries and key: see [`SeenKey::code`](crate::kernel::scenes::SeenKey::code).
    pub(super) codes: Vec<u8>,
}

thread_local! {
    /// As large as the largest scene of the thread. Those of a small one would take as long to allocate as to use.
    static BUFFERS: RefCell<SceneBuffers> = RefCell::default();
}

/// Makes this thread's buffers, as those of `kernel::buffer`.
pub(in crate::kernel) fn prepare_thread() {
    BUFFERS.with(|_| ());
}

/// A job, with the buffers of its thread.
pub(super) struct Buffered<'b, J> {
    pub(super) job: J,
    pub(super) buffers: &'b mut SceneBuffers,
}

/// Runs all jobs, of `work` multiplications together.
pub(super) fn run_buffered<J: Send>(dispatch: Dispatch, jobs: Vec<J>, work: usize)
where
    for<'b> Buffered<'b, J>: Kernel,
{
    run_jobs(jobs, work, |job| {
        BUFFERS.with_borrow_mut(|buffers| {
            dispatch.run(Buffered { job, buffers });
        });
    });
}

/// The terms added to the scores of two queries, indexed by the visibility code.
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
    /// Loads the codes of a task that covers a whole scene.
    pub(super) fn load_codes(&mut self, task: &SceneTask<'_>) {
        let pedestrians = task.scene.pedestrians;
        self.codes.clear();
        self.codes.resize(task.twos.len() * pedestrians, 0);
        let twos = self.codes.chunks_exact_mut(pedestrians);
        for (two, codes) in task.twos.clone().zip(twos) {
            for seen in task.scene.keys_of(two) {
                codes[seen.key()] = seen.code() as u8;
            }
        }
    }

    #[inline(always)]
    pub(super) fn load<S: Simd>(
        &mut self,
        simd: S,
        task: &SceneTask<'_>,
        [query, key, value]: [&[f32]; 3],
        group: usize,
    ) {
        let row = task.heads.row();
        let (asking, keys) = (task.queries(), task.keys.clone());
        let scale = simd.splat(heads::SCALE * std::f32::consts::LOG2_E);
        self.queries.resize(task.twos.len(), ZERO_QUAD);
        // Two keys are loaded at once; a missing one is stored as zeros.
        let count = keys.len().next_multiple_of(2);
        self.keys.resize(count, HalfQuad::ZERO);
        self.values.resize(count, HalfQuad::ZERO);
        let twos = query[row * asking.start..row * asking.end].chunks(2 * row);
        for (two, query) in twos.zip(&mut self.queries) {
            let loaded = heads::load(simd, group, &two[..row], two.get(row..2 * row));
            simd.write(simd.scaled(loaded, scale), query);
        }
        for (input, results) in [(key, &mut self.keys), (value, &mut self.values)] {
            let twos = input[row * keys.start..row * keys.end].chunks(2 * row);
            for (two, [low, high]) in twos.zip(results.as_chunks_mut().0) {
                let loaded = heads::load(simd, group, &two[..row], two.get(row..2 * row));
                simd.write_halves(loaded, low, high);
            }
        }
        self.bits.clear();
        if let Some(decisions) = task.decisions {
            for first in asking.step_by(2) {
                let query = |pedestrian| decisions.query(task.entry, task.scene.first + pedestrian);
                self.bits.push(LaneBits::new([query(first), query(first + 1)], group * GROUP));
            }
        }
    }
}
