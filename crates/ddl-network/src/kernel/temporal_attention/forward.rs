//! The forward pass: from queries, keys and values to mixed values.

use crate::kernel::heads::SCALE;
use crate::kernel::quads::Quads as _;
use crate::kernel::temporal_attention::sixteen_heads::{
    GROUP_NUMBERS, KeyValue, SixteenHeads, accumulate, are_prefetched, soften, weighted,
};
use ddl_simd::{DEPTH, Kernel, Lanes, Simd};

pub(super) struct TemporalForward<'a> {
    /// Index of the first number of these rows in the whole.
    pub(super) first: usize,
    pub(super) query: &'a [f32],
    pub(super) cache: &'a [KeyValue<&'a [f32]>],
    pub(super) newest: KeyValue<&'a [f32]>,
    /// The mixed values of these rows only.
    pub(super) mixed: &'a mut [f32],
}

impl Kernel for TemporalForward<'_> {
    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let scale = simd.splat(SCALE * std::f32::consts::LOG2_E);
        let length = self.mixed.len();
        let prefetched = are_prefetched(self.cache);
        // For each token: scores, then powers.
        let mut powers = vec![Lanes::ZERO; self.cache.len() + 1];
        for (group, mixed) in self.mixed.chunks_mut(GROUP_NUMBERS).enumerate() {
            let place = SixteenHeads::new(self.first, group * GROUP_NUMBERS, length);
            let query = simd.scaled(place.load(simd, self.query), scale);
            let share = soften(simd, place, query, self.cache, self.newest, &mut powers, prefetched);
            let mut sum = [simd.splat(0.0); DEPTH];
            for (power, token) in powers.iter().zip(self.cache.iter().chain([&self.newest])) {
                sum = accumulate(simd, sum, simd.load(&power.0), place.load(simd, token.value));
            }
            place.store(simd, weighted(simd, share, sum), mixed);
        }
    }
}
