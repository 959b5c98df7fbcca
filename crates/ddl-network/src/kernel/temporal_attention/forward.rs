//! The forward pass: from queries, keys and values to mixed values.

use crate::kernel::heads::Heads;
use crate::kernel::temporal_attention::sixteen_heads::{
    KeyValue, SixteenHeads, TemporalBuffers, accumulate, are_prefetched, soften, weighted,
};
use crate::kernel::threads::Buffered;
use ddl_simd::{DEPTH, Kernel, LANES, Simd, ZERO_QUAD};

pub(super) struct TemporalForward<'a> {
    pub(super) heads: Heads,
    /// Index of the first number of these rows in the whole.
    pub(super) first: usize,
    pub(super) query: &'a [f32],
    pub(super) cache: &'a [KeyValue<'a>],
    pub(super) newest: KeyValue<'a>,
    /// The mixed values of these rows only.
    pub(super) mixed: &'a mut [f32],
}

impl Kernel for Buffered<'_, TemporalForward<'_>, TemporalBuffers> {
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

impl Buffered<'_, TemporalForward<'_>, TemporalBuffers> {
    #[inline(always)]
    fn rows<S: Simd>(self, simd: S, width: usize, quads: usize) {
        let Self { job, buffers } = self;
        let scale = simd.splat(job.heads.scale() * std::f32::consts::LOG2_E);
        let length = job.mixed.len();
        buffers.query.resize(quads, ZERO_QUAD);
        let query = &mut buffers.query[..quads];
        let prefetched = are_prefetched(job.cache);
        for (group, mixed) in job.mixed.chunks_mut(LANES * width).enumerate() {
            let place = SixteenHeads::new(job.first, group * LANES * width, length, width);
            for (quad, query) in query.iter_mut().enumerate() {
                let loaded = place.load(simd, job.query, quad);
                simd.write(simd.scaled(loaded, scale), query);
            }
            let powers = &mut buffers.powers;
            let share = soften(simd, place, query, job.cache, job.newest, powers, prefetched);
            for quad in 0..quads {
                let mut sum = [simd.splat(0.0); DEPTH];
                let tokens = job.cache.iter().chain([&job.newest]);
                for (power, token) in powers.iter().zip(tokens) {
                    let value = place.load(simd, token.value, quad);
                    sum = accumulate(simd, sum, simd.load(&power.0), value);
                }
                place.store(simd, weighted(simd, share, sum), mixed, quad);
            }
        }
    }
}
