//! The backward pass: from the gradient of mixed values to those of queries, keys and values.
//!
//! With weights `w_ij = e_ij s_i`, where `s_i` is 1 over the sum of the powers `e_ij`, gradients `g_i` of mixed values
//! and drop factors `d_ij`: `dv_j = Σ_i d_ij w_ij g_i`, and the gradient of the score of (i, j) is `w_ij (d_ij g_i ·
//! v_j − g_i · mixed_i)`. The powers are computed again from the scores, which is faster than to store and load them.

use crate::kernel::heads;
use crate::kernel::quads::{Quads as _, ZERO_QUAD};
use crate::kernel::spatial_attention::queries::{Buffered, SceneBuffers, SceneTask, UNSEEN};
use ddl_simd::{DEPTH, Kernel, Lanes, Simd, Vectors};

pub(super) struct SceneBackward<'a> {
    pub(super) task: SceneTask<'a>,
    /// Queries, keys and values of the scene.
    pub(super) inputs: [&'a [f32]; 3],
    pub(super) mixed: &'a [f32],
    /// For each pair of queries and group of heads.
    pub(super) normalisers: &'a [[Lanes; 2]],
    pub(super) mixed_gradient: &'a [f32],
    pub(super) gradients: [&'a mut [f32]; 3],
}

impl Kernel for Buffered<'_, SceneBackward<'_>> {
    #[inline(always)]
    fn run<S: Simd>(mut self, simd: S) {
        let task = self.job.task.clone();
        self.buffers.load_codes(&task);
        for group in 0..task.heads.groups() {
            if task.decisions.is_some() {
                self.group::<S, true>(simd, group);
            } else {
                self.group::<S, false>(simd, group);
            }
        }
    }
}

impl Buffered<'_, SceneBackward<'_>> {
    #[inline(always)]
    fn group<S: Simd, const DROP: bool>(&mut self, simd: S, group: usize) {
        let task = self.job.task.clone();
        let row = task.heads.row();
        self.buffers.load(simd, &task, self.job.inputs, group);
        self.load_gradients(simd, group);
        let buffers = &mut *self.buffers;
        let [query_gradients, key_gradients, value_gradients] = &mut self.job.gradients;
        let rows = key_gradients.chunks_exact_mut(row);
        for (key, (key_gradient, value_gradient)) in rows.zip(value_gradients.chunks_exact_mut(row)).enumerate() {
            weigh::<S, DROP>(simd, buffers, &task, key);
            let (of_key, of_value) = spread(simd, buffers, key);
            // Undoes the scaling of the queries, which makes scores exponents of two.
            let of_key = simd.scaled(of_key, simd.splat(std::f32::consts::LN_2));
            heads::store_sum(simd, of_key, group, key_gradient);
            heads::store_sum(simd, of_value, group, value_gradient);
        }
        let scale = simd.splat(heads::SCALE);
        for (two, gradient) in query_gradients.chunks_mut(2 * row).zip(&buffers.query_gradients) {
            let (first, second) = two.split_at_mut(row);
            let second = (!second.is_empty()).then_some(second);
            heads::store(simd, simd.scaled(simd.read(gradient), scale), group, first, second);
        }
    }

    /// Loads gradients of mixed values and normalisers into lanes, and sets the gradients of queries to 0.
    #[inline(always)]
    fn load_gradients<S: Simd>(&mut self, simd: S, group: usize) {
        let (job, buffers) = (&self.job, &mut *self.buffers);
        let row = job.task.heads.row();
        let twos = job.task.scene.pedestrians.div_ceil(2);
        buffers.weights.resize(twos, Lanes::ZERO);
        buffers.score_gradients.resize(twos, Lanes::ZERO);
        buffers.inner.resize(twos, [Lanes::ZERO; 2]);
        buffers.mixed_gradients.resize(twos, ZERO_QUAD);
        buffers.query_gradients.clear();
        buffers.query_gradients.resize(twos, ZERO_QUAD);
        let rows = job.mixed_gradient.chunks(2 * row).zip(job.mixed.chunks(2 * row));
        let normalisers = job.normalisers.chunks_exact(job.task.heads.groups());
        let rows = rows.zip(normalisers.map(|groups| &groups[group]));
        let results = buffers.mixed_gradients.iter_mut().zip(&mut buffers.inner);
        for (((gradient, mixed), [largest, share]), (result, inner)) in rows.zip(results) {
            let [gradient, mixed] =
                [gradient, mixed].map(|two| heads::load(simd, group, &two[..row], two.get(row..2 * row)));
            let gradient = simd.scaled(gradient, simd.load(&share.0));
            let product = simd.dot(gradient, mixed, simd.splat(0.0));
            simd.write(gradient, result);
            inner[0] = *largest;
            simd.store(product, &mut inner[1].0);
        }
    }
}

/// For one key: the queries' weights times their sum, and the gradients of the scores.
#[inline(always)]
fn weigh<S: Simd, const DROP: bool>(simd: S, buffers: &mut SceneBuffers, task: &SceneTask<'_>, key: usize) {
    let (keys, values) = (simd.read_twice(&buffers.keys[key]), simd.read_twice(&buffers.values[key]));
    let codes = buffers.codes.chunks_exact(task.scene.pedestrians);
    let queries = buffers.queries.iter().zip(&buffers.mixed_gradients).zip(buffers.inner.iter().zip(codes));
    let results = buffers.weights.iter_mut().zip(&mut buffers.score_gradients);
    for (two, (((query, gradient), ([largest, inner], codes)), (weight, score_gradient))) in
        queries.zip(results).enumerate()
    {
        let unseen = simd.load(&UNSEEN[usize::from(codes[key] & 3)].0);
        let score = simd.dot(simd.read(query), keys, unseen);
        let power = simd.exp2(score - simd.load(&largest.0));
        let taken = simd.dot(simd.read(gradient), values, simd.splat(0.0));
        let inner = simd.load(&inner.0);
        let (taking, change) = match task.decisions {
            Some(decisions) if DROP => {
                let factors = decisions.factors(&buffers.bits[two], task.scene.first + key);
                let factors = simd.load(&factors.0);
                (power * factors, factors * taken - inner)
            }
            _ => (power, taken - inner),
        };
        simd.store(taking, &mut weight.0);
        simd.store(power * change, &mut score_gradient.0);
    }
}

/// Adds to the gradients of all queries. Returns those of a key and its value, separately for even and odd queries.
#[inline(always)]
fn spread<S: Simd>(simd: S, buffers: &mut SceneBuffers, key: usize) -> (Vectors<S>, Vectors<S>) {
    let (mut of_key, mut of_value) = ([simd.splat(0.0); DEPTH], [simd.splat(0.0); DEPTH]);
    let key = simd.read_twice(&buffers.keys[key]);
    let queries = buffers.queries.iter().zip(&buffers.mixed_gradients);
    let results = &mut buffers.query_gradients;
    let weights = buffers.weights.iter().zip(&buffers.score_gradients);
    for (((query, gradient), of_query), (weight, score_gradient)) in queries.zip(results).zip(weights) {
        let score_gradient = simd.load(&score_gradient.0);
        let (query, gradient) = (simd.read(query), simd.read(gradient));
        of_key = simd.accumulate(of_key, score_gradient, query);
        of_value = simd.accumulate(of_value, simd.load(&weight.0), gradient);
        simd.write(simd.accumulate(simd.read(of_query), score_gradient, key), of_query);
    }
    (of_key, of_value)
}
