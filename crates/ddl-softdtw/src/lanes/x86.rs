//! Vector instructions of x86-64 processors: the only unsafe code of the crate.
//!
//! [`Avx2`] and [`Avx512`] can be made by their `detect` alone, which asks the processor: whoever holds one may execute
//! its instructions.

#![allow(
    unsafe_code,
    reason = "instructions that not every processor has, and loads and stores through pointers"
)]
#![expect(clippy::inline_always, reason = "the lanes must stay in registers")]
#![allow(
    clippy::wildcard_imports,
    reason = "the names of instructions say where they are from"
)]

use std::arch::x86_64::*;

use super::exp2::{COST_LIMIT, UPWARD_POLYNOMIAL};
use super::{Kernel, Lanes, Simd, WideLanes};

/// Added to every sum of weighted predecessors, 2^−100. A fused product that is added to it is not rounded to a denormal
/// number on the way, so it can be smaller than [`super::FLOOR`].
const FUSED_FLOOR: f32 = f32::from_bits((127 - 100) << 23);

/// The proof that the processor has AVX2 and fused multiplication.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Avx2(());

/// The proof that the processor has AVX-512 F and DQ.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Avx512(());

/// Methods that are one expression of instructions of the set each.
macro_rules! instructions {
    ($(fn $name:ident($($argument:ident: $kind:ty),*) -> $result:ty = $value:expr;)*) => {$(
        #[inline(always)]
        fn $name(self, $($argument: $kind),*) -> $result {
            // SAFETY: `self` is the proof that the processor has the instructions, which touch no memory.
            unsafe { $value }
        }
    )*};
}

impl Avx2 {
    pub(crate) fn detect() -> Option<Self> {
        let found = is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma");
        found.then_some(Self(()))
    }
}

impl Simd for Avx2 {
    type Narrow = __m256;
    type Wide = __m256d;
    const WIDTH: usize = 8;
    const FLOOR: f32 = FUSED_FLOOR;

    #[inline]
    fn run<K: Kernel>(self, kernel: K) -> K::Output {
        #[target_feature(enable = "avx2,fma")]
        fn compiled<K: Kernel>(simd: Avx2, kernel: K) -> K::Output {
            kernel.run(simd)
        }
        // SAFETY: `self` is the proof that the processor has the instructions.
        unsafe { compiled(self, kernel) }
    }

    instructions! {
        fn splat(value: f32) -> __m256 = _mm256_set1_ps(value);
        fn add(a: __m256, b: __m256) -> __m256 = _mm256_add_ps(a, b);
        fn sub(a: __m256, b: __m256) -> __m256 = _mm256_sub_ps(a, b);
        fn mul(a: __m256, b: __m256) -> __m256 = _mm256_mul_ps(a, b);
        fn div(a: __m256, b: __m256) -> __m256 = _mm256_div_ps(a, b);
        fn mul_add(a: __m256, b: __m256, c: __m256) -> __m256 = _mm256_fmadd_ps(a, b, c);
        fn neg_mul_add(a: __m256, b: __m256, c: __m256) -> __m256 = _mm256_fnmadd_ps(a, b, c);
        fn max(a: __m256, b: __m256) -> __m256 = _mm256_max_ps(a, b);
        fn at_least(a: __m256, b: __m256) -> u32 = _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_GE_OQ>(a, b)).cast_unsigned();
        fn scale(power: __m256, exponent: __m256) -> __m256 = _mm256_castsi256_ps(_mm256_add_epi32(
            _mm256_castps_si256(power),
            _mm256_slli_epi32::<23>(_mm256_castps_si256(exponent)),
        ));
        fn wide_splat(value: f64) -> __m256d = _mm256_set1_pd(value);
        fn wide_add(a: __m256d, b: __m256d) -> __m256d = _mm256_add_pd(a, b);
        fn wide_sub(a: __m256d, b: __m256d) -> __m256d = _mm256_sub_pd(a, b);
        fn wide_mul(a: __m256d, b: __m256d) -> __m256d = _mm256_mul_pd(a, b);
        fn wide_max(a: __m256d, b: __m256d) -> __m256d = _mm256_max_pd(a, b);
        fn wide_sqrt(a: __m256d) -> __m256d = _mm256_sqrt_pd(a);
        fn wide_scale(power: __m256d, exponent: __m256d) -> __m256d = _mm256_castsi256_pd(_mm256_add_epi64(
            _mm256_castpd_si256(power),
            _mm256_slli_epi64::<52>(_mm256_castpd_si256(exponent)),
        ));
    }

    #[inline(always)]
    fn weigh(self, k: __m256, b: __m256) -> __m256 {
        self.mul_add(k, b, self.splat(FUSED_FLOOR))
    }

    #[inline(always)]
    fn cell(self, k: __m256, diagonal: __m256, up: __m256, left: __m256) -> __m256 {
        // `left` is the one that is waited for: it comes last.
        let others = self.mul_add(k, self.add(diagonal, up), self.splat(FUSED_FLOOR));
        self.mul_add(k, left, others)
    }

    #[inline(always)]
    fn load(self, from: &Lanes, part: usize) -> __m256 {
        assert!(part < Self::PARTS);
        // SAFETY: `self` is the proof that the processor has the instruction; part * WIDTH + WIDTH <= LANES, and the
        // instruction asks for no alignment.
        unsafe { _mm256_loadu_ps(from.as_ptr().add(part * Self::WIDTH)) }
    }

    #[inline(always)]
    fn store(self, value: __m256, into: &mut Lanes, part: usize) {
        assert!(part < Self::PARTS);
        // SAFETY: as in `load`.
        unsafe { _mm256_storeu_ps(into.as_mut_ptr().add(part * Self::WIDTH), value) }
    }

    #[inline(always)]
    fn wide_load(self, from: &WideLanes, part: usize) -> __m256d {
        assert!(part < Self::PARTS);
        // SAFETY: as in `load`; a wide group has half the lanes and a register holds half as many.
        unsafe { _mm256_loadu_pd(from.as_ptr().add(part * (Self::WIDTH / 2))) }
    }

    #[inline(always)]
    fn wide_store(self, value: __m256d, into: &mut WideLanes, part: usize) {
        assert!(part < Self::PARTS);
        // SAFETY: as in `wide_load`.
        unsafe { _mm256_storeu_pd(into.as_mut_ptr().add(part * (Self::WIDTH / 2)), value) }
    }
}

impl Avx512 {
    pub(crate) fn detect() -> Option<Self> {
        let found = is_x86_feature_detected!("avx512f") && is_x86_feature_detected!("avx512dq");
        found.then_some(Self(()))
    }
}

impl Simd for Avx512 {
    type Narrow = __m512;
    type Wide = __m512d;
    const WIDTH: usize = 16;
    const FLOOR: f32 = FUSED_FLOOR;

    #[inline]
    fn run<K: Kernel>(self, kernel: K) -> K::Output {
        #[target_feature(enable = "avx512f,avx512dq")]
        fn compiled<K: Kernel>(simd: Avx512, kernel: K) -> K::Output {
            kernel.run(simd)
        }
        // SAFETY: `self` is the proof that the processor has the instructions.
        unsafe { compiled(self, kernel) }
    }

    instructions! {
        fn splat(value: f32) -> __m512 = _mm512_set1_ps(value);
        fn add(a: __m512, b: __m512) -> __m512 = _mm512_add_ps(a, b);
        fn sub(a: __m512, b: __m512) -> __m512 = _mm512_sub_ps(a, b);
        fn mul(a: __m512, b: __m512) -> __m512 = _mm512_mul_ps(a, b);
        fn div(a: __m512, b: __m512) -> __m512 = _mm512_div_ps(a, b);
        fn mul_add(a: __m512, b: __m512, c: __m512) -> __m512 = _mm512_fmadd_ps(a, b, c);
        fn neg_mul_add(a: __m512, b: __m512, c: __m512) -> __m512 = _mm512_fnmadd_ps(a, b, c);
        fn max(a: __m512, b: __m512) -> __m512 = _mm512_max_ps(a, b);
        fn at_least(a: __m512, b: __m512) -> u32 = u32::from(_mm512_cmp_ps_mask::<_CMP_GE_OQ>(a, b));
        fn scale(power: __m512, exponent: __m512) -> __m512 = _mm512_castsi512_ps(_mm512_add_epi32(
            _mm512_castps_si512(power),
            _mm512_slli_epi32::<23>(_mm512_castps_si512(exponent)),
        ));
        fn wide_splat(value: f64) -> __m512d = _mm512_set1_pd(value);
        fn wide_add(a: __m512d, b: __m512d) -> __m512d = _mm512_add_pd(a, b);
        fn wide_sub(a: __m512d, b: __m512d) -> __m512d = _mm512_sub_pd(a, b);
        fn wide_mul(a: __m512d, b: __m512d) -> __m512d = _mm512_mul_pd(a, b);
        fn wide_max(a: __m512d, b: __m512d) -> __m512d = _mm512_max_pd(a, b);
        fn wide_sqrt(a: __m512d) -> __m512d = _mm512_sqrt_pd(a);
        fn wide_scale(power: __m512d, exponent: __m512d) -> __m512d = _mm512_castsi512_pd(_mm512_add_epi64(
            _mm512_castpd_si512(power),
            _mm512_slli_epi64::<52>(_mm512_castpd_si512(exponent)),
        ));
    }

    /// As in [`super::exp2`], with f = exponent − floor(exponent) and the power scaled by one instruction each.
    #[inline(always)]
    fn exp2_each<const G: usize>(self, mut exponents: [__m512; G]) -> [__m512; G] {
        let mut fractions = exponents;
        for g in 0..G {
            exponents[g] = self.max(exponents[g], self.splat(-COST_LIMIT));
            fractions[g] = self.above_floor(exponents[g]);
        }
        let [lower @ .., highest] = UPWARD_POLYNOMIAL;
        let mut powers = [self.splat(highest); G];
        for coefficient in lower.into_iter().rev() {
            for g in 0..G {
                powers[g] = self.mul_add(powers[g], fractions[g], self.splat(coefficient));
            }
        }
        for g in 0..G {
            powers[g] = self.scale_by_floor(powers[g], exponents[g]);
        }
        powers
    }

    #[inline(always)]
    fn weigh(self, k: __m512, b: __m512) -> __m512 {
        self.mul_add(k, b, self.splat(FUSED_FLOOR))
    }

    #[inline(always)]
    fn cell(self, k: __m512, diagonal: __m512, up: __m512, left: __m512) -> __m512 {
        // `left` is the one that is waited for: it comes last.
        let others = self.mul_add(k, self.add(diagonal, up), self.splat(FUSED_FLOOR));
        self.mul_add(k, left, others)
    }

    #[inline(always)]
    fn load(self, from: &Lanes, part: usize) -> __m512 {
        assert!(part < Self::PARTS);
        // SAFETY: `self` is the proof that the processor has the instruction; part * WIDTH + WIDTH <= LANES, and the
        // instruction asks for no alignment.
        unsafe { _mm512_loadu_ps(from.as_ptr().add(part * Self::WIDTH)) }
    }

    #[inline(always)]
    fn store(self, value: __m512, into: &mut Lanes, part: usize) {
        assert!(part < Self::PARTS);
        // SAFETY: as in `load`.
        unsafe { _mm512_storeu_ps(into.as_mut_ptr().add(part * Self::WIDTH), value) }
    }

    #[inline(always)]
    fn wide_load(self, from: &WideLanes, part: usize) -> __m512d {
        assert!(part < Self::PARTS);
        // SAFETY: as in `load`; a wide group has half the lanes and a register holds half as many.
        unsafe { _mm512_loadu_pd(from.as_ptr().add(part * (Self::WIDTH / 2))) }
    }

    #[inline(always)]
    fn wide_store(self, value: __m512d, into: &mut WideLanes, part: usize) {
        assert!(part < Self::PARTS);
        // SAFETY: as in `wide_load`.
        unsafe { _mm512_storeu_pd(into.as_mut_ptr().add(part * (Self::WIDTH / 2)), value) }
    }
}

impl Avx512 {
    instructions! {
        fn above_floor(a: __m512) -> __m512 = _mm512_reduce_ps::<{ _MM_FROUND_FLOOR }>(a);
        fn scale_by_floor(power: __m512, exponent: __m512) -> __m512 = _mm512_scalef_ps(power, exponent);
    }
}
