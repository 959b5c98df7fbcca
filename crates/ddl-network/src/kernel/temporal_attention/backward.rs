//! The backward pass: from the gradient of mixed values to those of queries, keys and values.
//!
//! With weights `w_e` and the gradient g of mixed values: `dv_e = w_e g`, and the gradient of score e is
//! `w_e (g · v_e − Σ_f w_f g · v_f)`.

use crate::kernel::heads::SCALE;
use crate::kernel::quads::Quads as _;
use crate::kernel::temporal_attention::sixteen_heads::{
    GROUP_NUMBERS, KeyValue, SixteenHeads, accumulate, dot, soften, weighted,
};
use ddl_simd::{DEPTH, Kernel, Lanes, Simd};
use fearless_simd::prelude::*;

pub(super) struct TemporalBackward<'a> {
    /// Index of the first number of these rows in the whole.
    pub(super) first: usize,
    pub(super) query: &'a [f32],
    pub(super) cache: &'a [KeyValue<&'a [f32]>],
    pub(super) newest: KeyValue<&'a [f32]>,
    pub(super) mixed_gradient: &'a [f32],
    /// The gradients of these rows only.
    pub(super) query_gradient: &'a mut [f32],
    /// The gradients of these rows only: the cached tokens, then the newest token.
    pub(super) token_gradients: Vec<KeyValue<&'a mut [f32]>>,
}

impl Kernel for TemporalBackward<'_> {
    #[inline(always)]
    fn run<S: Simd>(mut self, simd: S) {
        let length = self.query_gradient.len();
        let mut buffers = [0; 2].map(|_| vec![Lanes::ZERO; self.cache.len() + 1]);
        for group in (0..length).step_by(GROUP_NUMBERS) {
            self.group(simd, SixteenHeads::new(self.first, group, length), group, &mut buffers);
        }
    }
}

impl TemporalBackward<'_> {
    /// The buffers have for each token: its score, then power, then weight; and the product of its value and the
    /// gradient of the mixed values.
    #[inline(always)]
    fn group<S: Simd>(&mut self, simd: S, place: SixteenHeads, first: usize, [powers, taken]: &mut [Vec<Lanes>; 2]) {
        let query = simd.scaled(place.load(simd, self.query), simd.splat(SCALE * std::f32::consts::LOG2_E));
        let mixed_gradient = place.load(simd, self.mixed_gradient);
        let share = soften(simd, place, query, self.cache, self.newest, powers, false);
        let mut mean = simd.splat(0.0);
        let tokens = self.cache.iter().chain([&self.newest]);
        for ((power, taken), token) in powers.iter_mut().zip(&mut *taken).zip(tokens) {
            let product = dot(simd, mixed_gradient, place.load(simd, token.value));
            let weight = simd.load(&power.0) * share;
            mean = weight.mul_add(product, mean);
            simd.store(weight, &mut power.0);
            simd.store(product, &mut taken.0);
        }
        let mut query_gradient = [simd.splat(0.0); DEPTH];
        let tokens = self.cache.iter().chain([&self.newest]).zip(&mut self.token_gradients);
        for ((weight, taken), (token, gradients)) in powers.iter().zip(&*taken).zip(tokens) {
            let weight = simd.load(&weight.0);
            let score_gradient = weight * (simd.load(&taken.0) - mean);
            // Undoes the scaling of the queries, which makes scores exponents of two.
            let key_weight = score_gradient * std::f32::consts::LN_2;
            place.add(simd, weighted(simd, key_weight, query), &mut gradients.key[first..]);
            place.add(simd, weighted(simd, weight, mixed_gradient), &mut gradients.value[first..]);
            query_gradient = accumulate(simd, query_gradient, score_gradient, place.load(simd, token.key));
        }
        let gradient = simd.scaled(query_gradient, simd.splat(SCALE));
        place.add(simd, gradient, &mut self.query_gradient[first..]);
    }
}
