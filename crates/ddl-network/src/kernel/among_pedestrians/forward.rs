//! From queries, keys and values to mixed values.

use super::queries::{LARGE, SceneBuffers, SceneTask, UNSEEN, dot};
use crate::kernel::heads::HeadPart;
use crate::kernel::threads::Buffered;
use ddl_simd::{DEPTH, Kernel, Lanes, Quad, Simd};

pub(super) struct SceneForward<'a> {
    pub(super) task: SceneTask<'a>,
    pub(super) qkv: &'a [f32],
    pub(super) mixed: &'a mut [f32],
    /// By group of heads and two queries.
    pub(super) normalisers: &'a mut [[Lanes; 2]],
}

impl Kernel for Buffered<'_, SceneForward<'_>, SceneBuffers> {
    #[inline(always)]
    fn run<S: Simd>(mut self, simd: S) {
        let task = self.job.task;
        for group in 0..task.heads.groups() {
            // The number of quads is spelled out for the usual one, which takes the loops over quads away.
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
        let task = self.job.task;
        let (row, pedestrians) = (task.heads.row(), task.scene.pedestrians);
        self.buffers.load(simd, &task, self.job.qkv, group, quads);
        let buffers = &mut *self.buffers;
        buffers.weights.resize(pedestrians, Lanes::ZERO);
        let normalisers = &mut self.job.normalisers[group * pedestrians.div_ceil(2)..];
        let rows = self.job.mixed.chunks_mut(2 * row).zip(normalisers);
        let queries = buffers.queries.chunks_exact(quads);
        let queries = queries.zip(task.scene.codes.chunks_exact(pedestrians));
        for (two, ((mixed, normaliser), (query, codes))) in rows.zip(queries).enumerate() {
            // Which pedestrians are dropped depends on their places, and training scenes are small.
            let (codes, keys, values) = if !DROP && pedestrians > LARGE {
                let seen = &mut buffers.seen;
                seen.gather(codes, &buffers.keys, &buffers.values, quads);
                (&seen.codes[..], &seen.keys[..], &seen.values[..])
            } else {
                (codes, &buffers.keys[..], &buffers.values[..])
            };
            let weights = &mut buffers.weights[..codes.len()];
            let largest = scores(simd, query, keys, codes, weights);
            let mut sum = simd.splat(0.0);
            for (key, weight) in weights.iter_mut().enumerate() {
                let power = simd.exp2(simd.sub(simd.load(&weight.0), largest));
                sum = simd.add(sum, power);
                let taken = match task.decisions {
                    Some(decisions) if DROP => {
                        let factors = decisions.factors(&buffers.bits[two], task.scene.first + key);
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
                for (weight, value) in weights.iter().zip(values.chunks_exact(quads)) {
                    let value = simd.read(&value[quad]);
                    sum = simd.accumulate(sum, simd.load(&weight.0), value);
                }
                let part = HeadPart::new(task.heads, group, quad);
                part.store(simd, simd.scaled(sum, share), first, second.as_deref_mut());
            }
            simd.store(largest, &mut normaliser[0].0);
            simd.store(share, &mut normaliser[1].0);
        }
    }
}

#[inline(always)]
fn scores<S: Simd>(
    simd: S,
    query: &[Quad],
    keys: &[Quad],
    codes: &[u8],
    scores: &mut [Lanes],
) -> S::Floats {
    let mut largest = simd.splat(f32::NEG_INFINITY);
    let keys = keys.chunks_exact(query.len());
    for ((key, code), score) in keys.zip(codes).zip(scores) {
        let unseen = simd.load(&UNSEEN[usize::from(code & 3)].0);
        let value = dot(simd, query, key, unseen);
        simd.store(value, &mut score.0);
        largest = simd.max(largest, value);
    }
    largest
}
