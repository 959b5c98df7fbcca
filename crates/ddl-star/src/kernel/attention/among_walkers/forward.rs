//! From queries, keys and values to mixed values.

#![expect(clippy::inline_always, reason = "the lanes must stay in registers")]

use super::Task;
use super::queries::{Buffers, UNSEEN};
use crate::kernel::attention::exp2::exp2;
use crate::kernel::attention::heads::{GROUP, Part};
use crate::kernel::attention::instruction_set::Kernel;
use crate::kernel::attention::lanes::{DEPTH, Lanes, Vectors, accumulate, dot, scaled};

/// The rows of one scene.
#[derive(Debug)]
pub(super) struct Forward<'a> {
    pub(super) task: Task<'a>,
    pub(super) qkv: &'a [f32],
    pub(super) mixed: &'a mut [f32],
    pub(super) normalisers: &'a mut [f32],
}

#[derive(Debug)]
pub(super) struct Run<'a, 'b> {
    pub(super) job: Forward<'a>,
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
        let (row, walkers) = (task.heads.row(), task.scene.walkers);
        self.buffers.load(&task, self.job.qkv, group, blocks);
        let buffers = &mut *self.buffers;
        buffers.weights.resize(walkers, Lanes::ZERO);
        let normaliser = task.heads.groups() * 2 * GROUP;
        let rows = self.job.mixed.chunks_mut(2 * row);
        let rows = rows.zip(self.job.normalisers.chunks_mut(2 * normaliser));
        let queries = buffers.queries.chunks_exact(blocks);
        let codes = task.scene.codes.chunks_exact(walkers);
        for (i, (((mixed, normalisers), query), codes)) in rows.zip(queries).zip(codes).enumerate()
        {
            let weights = &mut buffers.weights[..];
            let largest = scores::<FUSED>(query, &buffers.keys, codes, weights);
            let mut sum = Lanes::ZERO;
            for (key, weight) in weights.iter_mut().enumerate() {
                let power = exp2::<FUSED>(weight.sub(largest));
                sum = sum.add(power);
                *weight = match task.decisions {
                    Some(decisions) if DROP => {
                        let key = task.scene.first + key;
                        power.mul(decisions.factors(&buffers.bits[i], key))
                    }
                    _ => power,
                };
            }
            let share = sum.reciprocal();
            for block in 0..blocks {
                let mut sum = [Lanes::ZERO; DEPTH];
                let values = buffers.values.chunks_exact(blocks);
                for (weight, value) in weights.iter().zip(values) {
                    accumulate::<FUSED>(&mut sum, *weight, &value[block]);
                }
                let sum = scaled(&sum, share);
                let part = Part::new(task.heads, group, block);
                let (first, second) = mixed.split_at_mut(row);
                part.store::<0>(&sum, first);
                if !second.is_empty() {
                    part.store::<GROUP>(&sum, second);
                }
            }
            for (walker, normaliser) in normalisers.chunks_exact_mut(normaliser).enumerate() {
                let (largest_of, share_of) =
                    normaliser[group * 2 * GROUP..][..2 * GROUP].split_at_mut(GROUP);
                largest_of.copy_from_slice(&largest.0[walker * GROUP..][..GROUP]);
                share_of.copy_from_slice(&share.0[walker * GROUP..][..GROUP]);
            }
        }
    }
}

/// Scores of two queries with every key, and the largest.
#[inline(always)]
fn scores<const FUSED: bool>(
    query: &[Vectors],
    keys: &[Vectors],
    codes: &[u8],
    scores: &mut [Lanes],
) -> Lanes {
    let mut largest = Lanes::splat(f32::NEG_INFINITY);
    let keys = keys.chunks_exact(query.len());
    for ((key, code), score) in keys.zip(codes).zip(scores) {
        *score = dot::<FUSED>(query, key, UNSEEN[usize::from(code & 3)]);
        largest = largest.max(*score);
    }
    largest
}
