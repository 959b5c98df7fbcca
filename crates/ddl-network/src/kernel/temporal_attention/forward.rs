//! The forward pass: from queries, keys and values to mixed values.

use crate::kernel::heads::SCALE;
use crate::kernel::quads::Quads as _;
use crate::kernel::temporal_attention::sixteen_heads::{
    GROUP_NUMBERS, KeyValue, SixteenHeads, TemporalBuffers, accumulate, are_prefetched, soften, weighted,
};
use crate::kernel::threads::Buffered;
use ddl_simd::{DEPTH, Kernel, Simd};

pub(super) struct TemporalForward<'a> {
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
        let Self { job, buffers } = self;
        let scale = simd.splat(SCALE * std::f32::consts::LOG2_E);
        let length = job.mixed.len();
        let prefetched = are_prefetched(job.cache);
        let powers = &mut buffers.powers;
        for (group, mixed) in job.mixed.chunks_mut(GROUP_NUMBERS).enumerate() {
            let place = SixteenHeads::new(job.first, group * GROUP_NUMBERS, length);
            let query = simd.scaled(place.load(simd, job.query), scale);
            let share = soften(simd, place, query, job.cache, job.newest, powers, prefetched);
            let mut sum = [simd.splat(0.0); DEPTH];
            for (power, token) in powers.iter().zip(job.cache.iter().chain([&job.newest])) {
                sum = accumulate(simd, sum, simd.load(&power.0), place.load(simd, token.value));
            }
            place.store(simd, weighted(simd, share, sum), mixed);
        }
    }
}
