//! From the gradient of mixed values to that of queries, keys and values.
//!
//! With weights w_ij = e_ij s_i, where s_i is 1 over the sum of the powers e_ij, gradients g_i of mixed values and drop
//! factors d_ij:
//! dv_j = Σ_i d_ij w_ij g_i, and the gradient of the score (i, j) is w_ij (d_ij g_i · v_j − g_i · mixed_i).
//! The powers are made anew from the scores: that is faster than to fetch them from where they would have to be kept.

#![expect(clippy::inline_always, reason = "the lanes must stay in registers")]

use super::Task;
use super::queries::{Buffers, UNSEEN};
use crate::kernel::attention::exp2::exp2;
use crate::kernel::attention::heads::{GROUP, Part};
use crate::kernel::attention::instruction_set::Kernel;
use crate::kernel::attention::lanes::{DEPTH, Lanes, Vectors, accumulate, dot, scaled};

/// The rows of one scene.
#[derive(Debug)]
pub(super) struct Backward<'a> {
    pub(super) task: Task<'a>,
    pub(super) qkv: &'a [f32],
    pub(super) mixed: &'a [f32],
    pub(super) normalisers: &'a [f32],
    pub(super) mixed_gradient: &'a [f32],
    pub(super) qkv_gradient: &'a mut [f32],
}

#[derive(Debug)]
pub(super) struct Run<'a, 'b> {
    pub(super) job: Backward<'a>,
    pub(super) buffers: &'b mut Buffers,
}

impl Kernel for Run<'_, '_> {
    #[inline(always)]
    fn run<const FUSED: bool>(mut self) {
        for group in 0..self.job.task.heads.groups() {
            // The number of blocks is spelled out for the usual one, which takes the loops over blocks away.
            match (
                self.job.task.heads.blocks(),
                self.job.task.decisions.is_some(),
            ) {
                (1, false) => self.group::<FUSED, false>(group, 1),
                (1, true) => self.group::<FUSED, true>(group, 1),
                (blocks, false) => self.group::<FUSED, false>(group, blocks),
                (blocks, true) => self.group::<FUSED, true>(group, blocks),
            }
        }
    }
}

impl Run<'_, '_> {
    #[inline(always)]
    fn group<const FUSED: bool, const DROP: bool>(&mut self, group: usize, blocks: usize) {
        let task = self.job.task;
        let row = task.heads.row();
        self.buffers.load(&task, self.job.qkv, group, blocks);
        self.load_gradients(group, blocks);
        let buffers = &mut *self.buffers;
        let twos = buffers.normalisers.len();
        buffers.query_gradients.clear();
        buffers
            .query_gradients
            .resize(twos * blocks, [Lanes::ZERO; DEPTH]);
        buffers.weights.resize(twos, Lanes::ZERO);
        buffers.score_gradients.resize(twos, Lanes::ZERO);
        let rows = self.job.qkv_gradient.chunks_exact_mut(3 * row);
        for (key, gradient) in rows.enumerate() {
            weigh::<FUSED, DROP>(buffers, &task, key, blocks);
            for block in 0..blocks {
                let (of_key, of_value) = spread::<FUSED>(buffers, key, block, blocks);
                let part = Part::new(task.heads, group, block);
                let (key_gradient, value_gradient) = gradient[row..].split_at_mut(row);
                // Queries were scaled to scores that are powers of two.
                let of_key = folded(&of_key, std::f32::consts::LN_2);
                part.store::<0>(&of_key, key_gradient);
                part.store::<0>(&folded(&of_value, 1.0), value_gradient);
            }
        }
        let scale = Lanes::splat(task.heads.scale());
        let gradients = buffers.query_gradients.chunks_exact(blocks);
        for (two, gradients) in self.job.qkv_gradient.chunks_mut(6 * row).zip(gradients) {
            let (first, second) = two.split_at_mut(3 * row);
            for (block, gradient) in gradients.iter().enumerate() {
                let part = Part::new(task.heads, group, block);
                let gradient = scaled(gradient, scale);
                part.store::<0>(&gradient, &mut first[..row]);
                if !second.is_empty() {
                    part.store::<GROUP>(&gradient, &mut second[..row]);
                }
            }
        }
    }

    /// Gradients of mixed values into lanes, with what normalises the weights.
    #[inline(always)]
    fn load_gradients(&mut self, group: usize, blocks: usize) {
        let heads = self.job.task.heads;
        let (row, normaliser) = (heads.row(), heads.groups() * 2 * GROUP);
        let buffers = &mut *self.buffers;
        buffers.mixed_gradients.clear();
        buffers.normalisers.clear();
        let rows = self.job.mixed_gradient.chunks(2 * row);
        let rows = rows.zip(self.job.mixed.chunks(2 * row));
        let rows = rows.zip(self.job.normalisers.chunks(2 * normaliser));
        for ((gradient, mixed), normalisers) in rows {
            let (mut largest, mut share, mut inner) = (Lanes::ZERO, Lanes::ZERO, Lanes::ZERO);
            for (walker, normaliser) in normalisers.chunks_exact(normaliser).enumerate() {
                let lanes = walker * GROUP..(walker + 1) * GROUP;
                let (largest_of, share_of) =
                    normaliser[group * 2 * GROUP..][..2 * GROUP].split_at(GROUP);
                largest.0[lanes.clone()].copy_from_slice(largest_of);
                share.0[lanes].copy_from_slice(share_of);
            }
            let (first, second) = gradient.split_at(row);
            let (first_mixed, second_mixed) = mixed.split_at(row);
            for block in 0..blocks {
                let part = Part::new(heads, group, block);
                part.dot_half::<0>(first, first_mixed, &mut inner);
                let vectors = if second.is_empty() {
                    part.load(first, None)
                } else {
                    part.dot_half::<GROUP>(second, second_mixed, &mut inner);
                    part.load(first, Some(second))
                };
                buffers.mixed_gradients.push(scaled(&vectors, share));
            }
            buffers.normalisers.push([largest, inner.mul(share)]);
        }
    }
}

/// Weights with which the queries took a key's value, times their sum, and gradients of their scores.
#[inline(always)]
fn weigh<const FUSED: bool, const DROP: bool>(
    buffers: &mut Buffers,
    task: &Task<'_>,
    key: usize,
    blocks: usize,
) {
    let codes = task.scene.codes[key..].iter().step_by(task.scene.walkers);
    let (vectors, value) = (key * blocks..(key + 1) * blocks, key * blocks);
    let (key_vectors, value_vectors) = (&buffers.keys[vectors], &buffers.values[value..][..blocks]);
    let queries = buffers.queries.chunks_exact(blocks);
    let gradients = buffers.mixed_gradients.chunks_exact(blocks);
    let queries = queries.zip(gradients).zip(&buffers.normalisers).zip(codes);
    let results = buffers.weights.iter_mut().zip(&mut buffers.score_gradients);
    for (i, ((((query, gradient), [largest, inner]), code), (weight, score_gradient))) in
        queries.zip(results).enumerate()
    {
        let score = dot::<FUSED>(query, key_vectors, UNSEEN[usize::from(code & 3)]);
        let power = exp2::<FUSED>(score.sub(*largest));
        let taken = dot::<FUSED>(gradient, value_vectors, Lanes::ZERO);
        match task.decisions {
            Some(decisions) if DROP => {
                let factor = decisions.factors(&buffers.bits[i], task.scene.first + key);
                *weight = power.mul(factor);
                *score_gradient = power.mul(factor.mul(taken).sub(*inner));
            }
            _ => {
                *weight = power;
                *score_gradient = power.mul(taken.sub(*inner));
            }
        }
    }
}

/// Adds to the gradients of all queries; gives those of a key and its value, still apart for even and odd queries.
#[inline(always)]
fn spread<const FUSED: bool>(
    buffers: &mut Buffers,
    key: usize,
    block: usize,
    blocks: usize,
) -> (Vectors, Vectors) {
    let (mut of_key, mut of_value) = ([Lanes::ZERO; DEPTH], [Lanes::ZERO; DEPTH]);
    let key = buffers.keys[key * blocks + block];
    let queries = buffers.queries.chunks_exact(blocks);
    let gradients = buffers.mixed_gradients.chunks_exact(blocks);
    let results = buffers.query_gradients.chunks_exact_mut(blocks);
    let weights = buffers.weights.iter().zip(&buffers.score_gradients);
    for (((query, gradient), of_query), (weight, score_gradient)) in
        queries.zip(gradients).zip(results).zip(weights)
    {
        accumulate::<FUSED>(&mut of_key, *score_gradient, &query[block]);
        accumulate::<FUSED>(&mut of_value, *weight, &gradient[block]);
        accumulate::<FUSED>(&mut of_query[block], *score_gradient, &key);
    }
    (of_key, of_value)
}

/// `factor` times the sum of both halves of the lanes, in the lower half.
#[inline(always)]
fn folded(vectors: &Vectors, factor: f32) -> Vectors {
    let mut result = [Lanes::ZERO; DEPTH];
    for d in 0..DEPTH {
        for lane in 0..GROUP {
            result[d].0[lane] = factor * (vectors[d].0[lane] + vectors[d].0[GROUP + lane]);
        }
    }
    result
}
