//! The forward pass: from queries, keys and values to mixed values.

use crate::kernel::heads;
use crate::kernel::quads::Quads as _;
use crate::kernel::scenes::SeenKey;
use crate::kernel::spatial_attention::queries::{Buffered, SceneTask, UNSEEN};
use ddl_simd::{DEPTH, Kernel, Lanes, Simd};
use fearless_simd::prelude::*;

pub(super) struct SceneForward<'a> {
    pub(super) task: SceneTask<'a>,
    /// Queries, keys and values of the scene.
    pub(super) inputs: [&'a [f32]; 3],
    pub(super) mixed: &'a mut [f32],
    /// For each pair of queries and group of heads; empty if they are not kept.
    pub(super) normalisers: &'a mut [[Lanes; 2]],
}

impl Kernel for Buffered<'_, SceneForward<'_>> {
    #[inline(always)]
    fn run<S: Simd>(mut self, simd: S) {
        let task = self.job.task.clone();
        for group in 0..task.heads.groups() {
            if task.decisions.is_some() {
                self.group::<S, true>(simd, group);
            } else {
                self.group::<S, false>(simd, group);
            }
        }
    }
}

impl Buffered<'_, SceneForward<'_>> {
    #[inline(always)]
    fn group<S: Simd, const DROP: bool>(&mut self, simd: S, group: usize) {
        let (task, row) = (&self.job.task, self.job.task.heads.row());
        self.buffers.load(simd, task, self.job.inputs, group);
        let buffers = &mut *self.buffers;
        // A key that is not visible would have the weight 0, so that leaving it out changes no bit.
        buffers.weights.resize(task.keys.len(), Lanes::ZERO);
        let mut normalisers = self.job.normalisers.chunks_exact_mut(task.heads.groups());
        let rows = self.job.mixed.chunks_mut(2 * row);
        let (keys, values) = (&buffers.keys[..], &buffers.values[..]);
        let queries = buffers.queries.iter().zip(task.twos.clone());
        for (pair, (mixed, (query, two))) in rows.zip(queries).enumerate() {
            let seen = task.scene.keys_of(two);
            let weights = &mut buffers.weights[..seen.len()];
            let first = task.keys.start;
            let place = |seen: &SeenKey| seen.key() - first;
            let mut largest = simd.splat(f32::NEG_INFINITY);
            let query = simd.read(query);
            for (seen, weight) in seen.iter().zip(&mut *weights) {
                let unseen = simd.load(&UNSEEN[seen.code()].0);
                let score = simd.dot(query, simd.read_twice(&keys[place(seen)]), unseen);
                simd.store(score, &mut weight.0);
                largest = largest.max(score);
            }
            let mut sum = simd.splat(0.0);
            for (seen, weight) in seen.iter().zip(&mut *weights) {
                let power = simd.exp2(simd.load(&weight.0) - largest);
                sum += power;
                let taken = match task.decisions {
                    Some(decisions) if DROP => {
                        let key = task.scene.first + seen.key();
                        let factors = decisions.factors(&buffers.bits[pair], key);
                        power * simd.load(&factors.0)
                    }
                    _ => power,
                };
                simd.store(taken, &mut weight.0);
            }
            let share = simd.splat(1.0) / sum;
            let (first, second) = mixed.split_at_mut(row);
            let second = (!second.is_empty()).then_some(second);
            let mut sum = [simd.splat(0.0); DEPTH];
            for (seen, weight) in seen.iter().zip(&*weights) {
                let value = simd.read_twice(&values[place(seen)]);
                sum = simd.accumulate(sum, simd.load(&weight.0), value);
            }
            heads::store(simd, simd.scaled(sum, share), group, first, second);
            if let Some(normaliser) = normalisers.next() {
                simd.store(largest, &mut normaliser[group][0].0);
                simd.store(share, &mut normaliser[group][1].0);
            }
        }
    }
}
