//! The backward pass: from the gradient of mixed values to those of queries, keys and values.
//!
//! With weights `w_e` and the gradient g of mixed values: `dv_e = w_e g`, and the gradient of score e is
//! `w_e (g · v_e − Σ_f w_f g · v_f)`.

use crate::kernel::heads::Heads;
use crate::kernel::temporal_attention::sixteen_heads::{
    KeyValue, KeyValueMut, SixteenHeads, TemporalBuffers, accumulate, dot, soften, weighted,
};
use crate::kernel::threads::Buffered;
use ddl_simd::{DEPTH, Kernel, LANES, Lanes, Simd, ZERO_QUAD};

pub(super) struct TemporalBackward<'a> {
    pub(super) heads: Heads,
    /// Index of the first number of these rows in the whole.
    pub(super) first: usize,
    pub(super) query: &'a [f32],
    pub(super) cache: &'a [KeyValue<'a>],
    pub(super) newest: KeyValue<'a>,
    pub(super) mixed_gradient: &'a [f32],
    /// The gradients of these rows only.
    pub(super) query_gradient: &'a mut [f32],
    /// The gradients of these rows only: the cached tokens, then the newest token.
    pub(super) token_gradients: Vec<KeyValueMut<'a>>,
}

impl Kernel for Buffered<'_, TemporalBackward<'_>, TemporalBuffers> {
    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        // The usual width is a constant, so that the compiler unrolls the loops over quads.
        match self.job.heads.width {
            DEPTH => self.rows(simd, DEPTH, 1),
            width => {
                let quads = self.job.heads.quads();
                self.rows(simd, width, quads);
            }
        }
    }
}

impl Buffered<'_, TemporalBackward<'_>, TemporalBuffers> {
    #[inline(always)]
    fn rows<S: Simd>(mut self, simd: S, width: usize, quads: usize) {
        let length = self.job.query_gradient.len();
        self.buffers.query.resize(quads, ZERO_QUAD);
        self.buffers.mixed_gradient.resize(quads, ZERO_QUAD);
        self.buffers.query_gradient.resize(quads, ZERO_QUAD);
        let tokens = self.job.cache.len() + 1;
        self.buffers.taken.resize(tokens, Lanes::ZERO);
        for group in (0..length).step_by(LANES * width) {
            let place = SixteenHeads::new(self.job.first, group, length, width);
            self.group(simd, place, group, quads);
        }
    }

    #[inline(always)]
    fn group<S: Simd>(&mut self, simd: S, place: SixteenHeads, first: usize, quads: usize) {
        let (job, buffers) = (&mut self.job, &mut *self.buffers);
        let scale = job.heads.scale();
        let to_scores = simd.splat(scale * std::f32::consts::LOG2_E);
        let query = &mut buffers.query[..quads];
        let mixed_gradient = &mut buffers.mixed_gradient[..quads];
        let query_gradient = &mut buffers.query_gradient[..quads];
        for quad in 0..quads {
            let loaded = place.load(simd, job.query, quad);
            simd.write(simd.scaled(loaded, to_scores), &mut query[quad]);
            let gradient = place.load(simd, job.mixed_gradient, quad);
            simd.write(gradient, &mut mixed_gradient[quad]);
            query_gradient[quad] = ZERO_QUAD;
        }
        let powers = &mut buffers.powers;
        let share = soften(simd, place, query, job.cache, job.newest, powers, false);
        let mut mean = simd.splat(0.0);
        let tokens = job.cache.iter().chain([&job.newest]);
        let weights = powers.iter_mut().zip(&mut buffers.taken);
        for ((power, taken), token) in weights.zip(tokens) {
            let mut product = simd.splat(0.0);
            for (quad, gradient) in mixed_gradient.iter().enumerate() {
                let value = place.load(simd, token.value, quad);
                product = dot(simd, simd.read(gradient), value, product);
            }
            let weight = simd.mul(simd.load(&power.0), share);
            mean = simd.mul_add(weight, product, mean);
            simd.store(weight, &mut power.0);
            simd.store(product, &mut taken.0);
        }
        let tokens = job.cache.iter().chain([&job.newest]);
        let tokens = tokens.zip(&mut job.token_gradients);
        let weights = powers.iter().zip(&buffers.taken);
        for ((weight, taken), (token, gradients)) in weights.zip(tokens) {
            let weight = simd.load(&weight.0);
            let score_gradient = simd.mul(weight, simd.sub(simd.load(&taken.0), mean));
            // Undoes the scaling of the queries, which makes scores exponents of two.
            let key_weight = simd.mul(score_gradient, simd.splat(std::f32::consts::LN_2));
            for quad in 0..quads {
                let of_key = weighted(simd, key_weight, simd.read(&query[quad]));
                place.add(simd, of_key, &mut gradients.key[first..], quad);
                let of_value = weighted(simd, weight, simd.read(&mixed_gradient[quad]));
                place.add(simd, of_value, &mut gradients.value[first..], quad);
                let key = place.load(simd, token.key, quad);
                let sum = simd.read(&query_gradient[quad]);
                let sum = accumulate(simd, sum, score_gradient, key);
                simd.write(sum, &mut query_gradient[quad]);
            }
        }
        for (quad, gradient) in query_gradient.iter().enumerate() {
            let gradient = simd.scaled(simd.read(gradient), simd.splat(scale));
            place.add(simd, gradient, &mut job.query_gradient[first..], quad);
        }
    }
}
