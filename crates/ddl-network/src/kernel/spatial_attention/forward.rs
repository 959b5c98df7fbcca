//! The forward pass: from queries, keys and values to mixed values.

use crate::kernel::heads::HeadPart;
use crate::kernel::scenes::SeenKey;
use crate::kernel::spatial_attention::queries::{SceneBuffers, SceneTask, UNSEEN, dot};
use crate::kernel::threads::Buffered;
use ddl_simd::{DEPTH, Kernel, Lanes, Simd};

pub(super) struct SceneForward<'a> {
    pub(super) task: SceneTask<'a>,
    /// Queries, keys and values of the scene.
    pub(super) inputs: [&'a [f32]; 3],
    pub(super) mixed: &'a mut [f32],
    /// For each pair of queries and group of heads; empty if they are not kept.
    pub(super) normalisers: &'a mut [[Lanes; 2]],
}

impl Kernel for Buffered<'_, SceneForward<'_>, SceneBuffers> {
    #[inline(always)]
    fn run<S: Simd>(mut self, simd: S) {
        let task = self.job.task.clone();
        for group in 0..task.heads.groups() {
            // The usual number of quads is a constant, so that the compiler unrolls the loops over quads.
            match (task.heads.quads(), task.decisions.is_some()) {
                (1, false) => self.group::<S, false>(simd, group, 1),
                (1, true) => self.group::<S, true>(simd, group, 1),
                (quads, false) => self.group::<S, false>(simd, group, quads),
                (quads, true) => self.group::<S, true>(simd, group, quads),
            }
        }
    }
}

impl Buffered<'_, SceneForward<'_>, SceneBuffers> {
    #[inline(always)]
    fn group<S: Simd, const DROP: bool>(&mut self, simd: S, group: usize, quads: usize) {
        let (task, row) = (&self.job.task, self.job.task.heads.row());
        self.buffers.load(simd, task, self.job.inputs, group, quads);
        let buffers = &mut *self.buffers;
        // A key that is not visible would have the weight 0, so that leaving it out changes no bit.
        buffers.weights.resize(task.keys.len(), Lanes::ZERO);
        let mut normalisers = self.job.normalisers.chunks_exact_mut(task.heads.groups());
        let rows = self.job.mixed.chunks_mut(2 * row);
        let (keys, values) = (&buffers.keys[..], &buffers.values[..]);
        let queries = buffers.queries.chunks_exact(quads).zip(task.twos.clone());
        for (pair, (mixed, (query, two))) in rows.zip(queries).enumerate() {
            let seen = task.scene.of(two);
            let weights = &mut buffers.weights[..seen.len()];
            let first = task.keys.start;
            let place = |seen: &SeenKey| (seen.key() - first) * quads;
            let mut largest = simd.splat(f32::NEG_INFINITY);
            // The first quad of the queries is read once, not for each key.
            let (in_registers, others) = (simd.read(&query[0]), &query[1..]);
            for (seen, weight) in seen.iter().zip(&mut *weights) {
                let key = &keys[place(seen)..][..quads];
                let unseen = simd.load(&UNSEEN[seen.code()].0);
                let score = simd.dot(in_registers, simd.read_twice(&key[0]), unseen);
                let score = dot(simd, others, &key[1..], score);
                simd.store(score, &mut weight.0);
                largest = simd.max(largest, score);
            }
            let mut sum = simd.splat(0.0);
            for (seen, weight) in seen.iter().zip(&mut *weights) {
                let power = simd.exp2(simd.sub(simd.load(&weight.0), largest));
                sum = simd.add(sum, power);
                let taken = match task.decisions {
                    Some(decisions) if DROP => {
                        let key = task.scene.first + seen.key();
                        let factors = decisions.factors(&buffers.bits[pair], key);
                        simd.mul(power, simd.load(&factors.0))
                    }
                    _ => power,
                };
                simd.store(taken, &mut weight.0);
            }
            let share = simd.div(simd.splat(1.0), sum);
            let (first, second) = mixed.split_at_mut(row);
            let mut second = (!second.is_empty()).then_some(second);
            for quad in 0..quads {
                let mut sum = [simd.splat(0.0); DEPTH];
                for (seen, weight) in seen.iter().zip(&*weights) {
                    let value = simd.read_twice(&values[place(seen) + quad]);
                    sum = simd.accumulate(sum, simd.load(&weight.0), value);
                }
                let part = HeadPart::new(task.heads, group, quad);
                part.store(simd, simd.scaled(sum, share), first, second.as_deref_mut());
            }
            if let Some(normaliser) = normalisers.next() {
                simd.store(largest, &mut normaliser[group][0].0);
                simd.store(share, &mut normaliser[group][1].0);
            }
        }
    }
}
