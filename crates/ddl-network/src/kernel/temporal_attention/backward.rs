//! The backward pass: from the gradient of mixed values to those of queries, keys and values.
//!
//! With weights `w_e` and the gradient g of mixed values: `dv_e = w_e g`, and the gradient of score e is
//! `w_e (g · v_e − Σ_f w_f g · v_f)`.

use crate::kernel::heads::SCALE;
use crate::kernel::quads::Quads as _;
use crate::kernel::temporal_attention::sixteen_heads::{
    GROUP_NUMBERS, KeyValue, KeyValueMut, SixteenHeads, TemporalBuffers, accumulate, dot, soften, weighted,
};
use crate::kernel::threads::Buffered;
use ddl_simd::{DEPTH, Kernel, Lanes, Simd};
use fearless_simd::prelude::*;

pub(super) struct TemporalBackward<'a> {
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
    fn run<S: Simd>(mut self, simd: S) {
        let length = self.job.query_gradient.len();
        self.buffers.taken.resize(self.job.cache.len() + 1, Lanes::ZERO);
        for group in (0..length).step_by(GROUP_NUMBERS) {
            self.group(simd, SixteenHeads::new(self.job.first, group, length), group);
        }
    }
}

impl Buffered<'_, TemporalBackward<'_>, TemporalBuffers> {
    #[inline(always)]
    fn group<S: Simd>(&mut self, simd: S, place: SixteenHeads, first: usize) {
        let (job, buffers) = (&mut self.job, &mut *self.buffers);
        let query = simd.scaled(
            place.load(simd, job.query),
            simd.splat(SCALE * std::f32::consts::LOG2_E),
        );
        let mixed_gradient = place.load(simd, job.mixed_gradient);
        let powers = &mut buffers.powers;
        let share = soften(simd, place, query, job.cache, job.newest, powers, false);
        let mut mean = simd.splat(0.0);
        let tokens = job.cache.iter().chain([&job.newest]);
        for ((power, taken), token) in powers.iter_mut().zip(&mut buffers.taken).zip(tokens) {
            let product = dot(simd, mixed_gradient, place.load(simd, token.value));
            let weight = simd.load(&power.0) * share;
            mean = weight.mul_add(product, mean);
            simd.store(weight, &mut power.0);
            simd.store(product, &mut taken.0);
        }
        let mut query_gradient = [simd.splat(0.0); DEPTH];
        let tokens = job.cache.iter().chain([&job.newest]);
        let tokens = tokens.zip(&mut job.token_gradients);
        for ((weight, taken), (token, gradients)) in powers.iter().zip(&buffers.taken).zip(tokens) {
            let weight = simd.load(&weight.0);
            let score_gradient = weight * (simd.load(&taken.0) - mean);
            // Undoes the scaling of the queries, which makes scores exponents of two.
            let key_weight = score_gradient * std::f32::consts::LN_2;
            place.add(simd, weighted(simd, key_weight, query), &mut gradients.key[first..]);
            place.add(
                simd,
                weighted(simd, weight, mixed_gradient),
                &mut gradients.value[first..],
            );
            query_gradient = accumulate(simd, query_gradient, score_gradient, place.load(simd, token.key));
        }
        let gradient = simd.scaled(query_gradient, simd.splat(SCALE));
        place.add(simd, gradient, &mut job.query_gradient[first..]);
    }
}
