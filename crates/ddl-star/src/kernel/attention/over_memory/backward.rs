//! From the gradient of mixed values to that of queries, keys and values.
//!
//! With weights w_e and the gradient g of mixed values: dv_e = w_e g, and the gradient of score e is
//! w_e (g · v_e − Σ_f w_f g · v_f).

#![expect(clippy::inline_always, reason = "the lanes must stay in registers")]

use super::tokens::{Buffers, Place, accumulate, dot, soften, weighted};
use super::{KeyValue, KeyValueMut};
use crate::kernel::attention::heads::Heads;
use crate::kernel::attention::instruction_set::Kernel;
use crate::kernel::attention::lanes::{DEPTH, LANES, Lanes, scaled};

/// Some of the rows.
#[derive(Debug)]
pub(super) struct Backward<'a> {
    pub(super) heads: Heads,
    /// Where the rows start in the whole.
    pub(super) first: usize,
    pub(super) query: &'a [f32],
    pub(super) memory: &'a [KeyValue<'a>],
    pub(super) own: KeyValue<'a>,
    pub(super) mixed_gradient: &'a [f32],
    /// Of these rows alone.
    pub(super) query_gradient: &'a mut [f32],
    /// Of these rows alone: the remembered tokens, then the own one.
    pub(super) token_gradients: Vec<KeyValueMut<'a>>,
}

#[derive(Debug)]
pub(super) struct Run<'a, 'b> {
    pub(super) job: Backward<'a>,
    pub(super) buffers: &'b mut Buffers,
}

impl Kernel for Run<'_, '_> {
    #[inline(always)]
    fn run<const FUSED: bool>(self) {
        // The usual width is spelled out, which takes the loops over blocks away.
        match self.job.heads.width {
            DEPTH => self.rows::<FUSED>(DEPTH, 1),
            width => {
                let blocks = self.job.heads.blocks();
                self.rows::<FUSED>(width, blocks);
            }
        }
    }
}

impl Run<'_, '_> {
    #[inline(always)]
    fn rows<const FUSED: bool>(mut self, width: usize, blocks: usize) {
        let length = self.job.query_gradient.len();
        for at in (0..length).step_by(LANES * width) {
            let place = Place::new(self.job.first, at, length, width);
            self.group::<FUSED>(place, at, blocks);
        }
    }

    #[inline(always)]
    fn group<const FUSED: bool>(&mut self, place: Place, at: usize, blocks: usize) {
        let (job, buffers) = (&mut self.job, &mut *self.buffers);
        let scale = job.heads.scale();
        let to_scores = Lanes::splat(scale * std::f32::consts::LOG2_E);
        buffers.query.clear();
        buffers.mixed_gradient.clear();
        buffers.query_gradient.clear();
        for block in 0..blocks {
            let query = place.load(job.query, block);
            buffers.query.push(scaled(&query, to_scores));
            let gradient = place.load(job.mixed_gradient, block);
            buffers.mixed_gradient.push(gradient);
            buffers.query_gradient.push([Lanes::ZERO; DEPTH]);
        }
        let powers = &mut buffers.powers;
        let share = soften::<FUSED>(place, &buffers.query, job.memory, job.own, powers);
        buffers.taken.clear();
        let mut mean = Lanes::ZERO;
        for (power, token) in powers.iter_mut().zip(job.memory.iter().chain([&job.own])) {
            let mut taken = Lanes::ZERO;
            for (block, gradient) in buffers.mixed_gradient.iter().enumerate() {
                taken = dot(gradient, &place.load(token.value, block), taken);
            }
            *power = power.mul(share);
            mean = power.mul_add::<FUSED>(taken, mean);
            buffers.taken.push(taken);
        }
        let tokens = job.memory.iter().chain([&job.own]);
        let tokens = tokens.zip(&mut job.token_gradients);
        let weights = powers.iter().zip(&buffers.taken);
        for ((weight, taken), (token, gradients)) in weights.zip(tokens) {
            let score_gradient = weight.mul(taken.sub(mean));
            // Queries were scaled to scores that are powers of two.
            let key_weight = score_gradient.mul(Lanes::splat(std::f32::consts::LN_2));
            for block in 0..blocks {
                let of_key = weighted(key_weight, &buffers.query[block]);
                place.add(&of_key, &mut gradients.key[at..], block);
                let of_value = weighted(*weight, &buffers.mixed_gradient[block]);
                place.add(&of_value, &mut gradients.value[at..], block);
                let of_query = &mut buffers.query_gradient[block];
                accumulate::<FUSED>(of_query, score_gradient, &place.load(token.key, block));
            }
        }
        for (block, gradient) in buffers.query_gradient.iter().enumerate() {
            let gradient = scaled(gradient, Lanes::splat(scale));
            place.add(&gradient, &mut job.query_gradient[at..], block);
        }
    }
}
