//! Vector instructions of x86-64 processors: the only unsafe code of the kernels.
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

use super::lanes::LANES;
use super::simd::{Kernel, Simd};

/// The proof that the processor has AVX2 and fused multiplication.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Avx2(());

/// The proof that the processor has AVX-512 F.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Avx512(());

impl Avx2 {
    pub(crate) fn detect() -> Option<Self> {
        let found = is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma");
        found.then_some(Self(()))
    }
}

impl Avx512 {
    /// With the instructions of AVX2, which code that is compiled along may use.
    pub(crate) fn detect() -> Option<Self> {
        let found = Avx2::detect().is_some() && is_x86_feature_detected!("avx512f");
        found.then_some(Self(()))
    }
}

/// Methods that are one expression of instructions of the set each.
macro_rules! instructions {
    ($(fn $name:ident$(<const $n:ident: i32>)?($($argument:ident: $kind:ty),*) -> $result:ty = $value:expr;)*) => {$(
        #[inline(always)]
        fn $name$(<const $n: i32>)?(self, $($argument: $kind),*) -> $result {
            // SAFETY: `self` is the proof that the processor has the instructions. They touch no memory but, without
            // asking for alignment, the sixteen numbers of an array.
            unsafe { $value }
        }
    )*};
}

impl Simd for Avx512 {
    type Wide = __m512;

    #[inline]
    fn run<K: Kernel>(self, kernel: K) {
        #[target_feature(enable = "avx2,fma,avx512f")]
        fn compiled<K: Kernel>(simd: Avx512, kernel: K) {
            kernel.run(simd);
        }
        // SAFETY: `self` is the proof that the processor has the instructions.
        unsafe { compiled(self, kernel) }
    }

    instructions! {
        fn splat(value: f32) -> __m512 = _mm512_set1_ps(value);
        fn load(from: &[f32; LANES]) -> __m512 = _mm512_loadu_ps(from.as_ptr());
        fn store(value: __m512, into: &mut [f32; LANES]) -> () = _mm512_storeu_ps(into.as_mut_ptr(), value);
        fn add(a: __m512, b: __m512) -> __m512 = _mm512_add_ps(a, b);
        fn sub(a: __m512, b: __m512) -> __m512 = _mm512_sub_ps(a, b);
        fn mul(a: __m512, b: __m512) -> __m512 = _mm512_mul_ps(a, b);
        fn div(a: __m512, b: __m512) -> __m512 = _mm512_div_ps(a, b);
        fn max(a: __m512, b: __m512) -> __m512 = _mm512_max_ps(a, b);
        fn mul_add(a: __m512, b: __m512, c: __m512) -> __m512 = _mm512_fmadd_ps(a, b, c);
        fn scale(power: __m512, exponent: __m512) -> __m512 = _mm512_castsi512_ps(_mm512_add_epi32(
            _mm512_castps_si512(power),
            _mm512_slli_epi32::<23>(_mm512_castps_si512(exponent)),
        ));
        fn spread<const FROM: i32>(a: __m512) -> __m512 = _mm512_permute_ps::<FROM>(a);
        fn transpose(groups: [__m512; 4]) -> [__m512; 4] = {
            let [a, b, c, d] = groups;
            let [low, high] = [_mm512_unpacklo_ps(a, b), _mm512_unpacklo_ps(c, d)];
            let [low, high] = [_mm512_castps_pd(low), _mm512_castps_pd(high)];
            let [first, second] = [_mm512_unpacklo_pd(low, high), _mm512_unpackhi_pd(low, high)];
            let [low, high] = [_mm512_unpackhi_ps(a, b), _mm512_unpackhi_ps(c, d)];
            let [low, high] = [_mm512_castps_pd(low), _mm512_castps_pd(high)];
            let [third, fourth] = [_mm512_unpacklo_pd(low, high), _mm512_unpackhi_pd(low, high)];
            [
                _mm512_castpd_ps(first),
                _mm512_castpd_ps(second),
                _mm512_castpd_ps(third),
                _mm512_castpd_ps(fourth),
            ]
        };
    }
}

/// Lanes 0 to 7, and 8 to 15.
type Two = [__m256; 2];

impl Avx2 {
    instructions! {
        fn transpose_half(groups: [__m256; 4]) -> [__m256; 4] = {
            let [a, b, c, d] = groups;
            let [low, high] = [_mm256_unpacklo_ps(a, b), _mm256_unpacklo_ps(c, d)];
            let [low, high] = [_mm256_castps_pd(low), _mm256_castps_pd(high)];
            let [first, second] = [_mm256_unpacklo_pd(low, high), _mm256_unpackhi_pd(low, high)];
            let [low, high] = [_mm256_unpackhi_ps(a, b), _mm256_unpackhi_ps(c, d)];
            let [low, high] = [_mm256_castps_pd(low), _mm256_castps_pd(high)];
            let [third, fourth] = [_mm256_unpacklo_pd(low, high), _mm256_unpackhi_pd(low, high)];
            [
                _mm256_castpd_ps(first),
                _mm256_castpd_ps(second),
                _mm256_castpd_ps(third),
                _mm256_castpd_ps(fourth),
            ]
        };
        fn scale_half(power: __m256, exponent: __m256) -> __m256 = _mm256_castsi256_ps(_mm256_add_epi32(
            _mm256_castps_si256(power),
            _mm256_slli_epi32::<23>(_mm256_castps_si256(exponent)),
        ));
    }
}

impl Simd for Avx2 {
    type Wide = Two;

    #[inline]
    fn run<K: Kernel>(self, kernel: K) {
        #[target_feature(enable = "avx2,fma")]
        fn compiled<K: Kernel>(simd: Avx2, kernel: K) {
            kernel.run(simd);
        }
        // SAFETY: `self` is the proof that the processor has the instructions.
        unsafe { compiled(self, kernel) }
    }

    instructions! {
        fn splat(value: f32) -> Two = [_mm256_set1_ps(value); 2];
        fn load(from: &[f32; LANES]) -> Two = [_mm256_loadu_ps(from.as_ptr()), _mm256_loadu_ps(from.as_ptr().add(8))];
        fn store(value: Two, into: &mut [f32; LANES]) -> () = {
            _mm256_storeu_ps(into.as_mut_ptr(), value[0]);
            _mm256_storeu_ps(into.as_mut_ptr().add(8), value[1]);
        };
        fn add(a: Two, b: Two) -> Two = [_mm256_add_ps(a[0], b[0]), _mm256_add_ps(a[1], b[1])];
        fn sub(a: Two, b: Two) -> Two = [_mm256_sub_ps(a[0], b[0]), _mm256_sub_ps(a[1], b[1])];
        fn mul(a: Two, b: Two) -> Two = [_mm256_mul_ps(a[0], b[0]), _mm256_mul_ps(a[1], b[1])];
        fn div(a: Two, b: Two) -> Two = [_mm256_div_ps(a[0], b[0]), _mm256_div_ps(a[1], b[1])];
        fn max(a: Two, b: Two) -> Two = [_mm256_max_ps(a[0], b[0]), _mm256_max_ps(a[1], b[1])];
        fn mul_add(a: Two, b: Two, c: Two) -> Two = [
            _mm256_fmadd_ps(a[0], b[0], c[0]),
            _mm256_fmadd_ps(a[1], b[1], c[1]),
        ];
        fn spread<const FROM: i32>(a: Two) -> Two = [_mm256_permute_ps::<FROM>(a[0]), _mm256_permute_ps::<FROM>(a[1])];
    }

    #[inline(always)]
    fn scale(self, power: Two, exponent: Two) -> Two {
        [
            self.scale_half(power[0], exponent[0]),
            self.scale_half(power[1], exponent[1]),
        ]
    }

    #[inline(always)]
    fn transpose(self, [a, b, c, d]: [Two; 4]) -> [Two; 4] {
        let low = self.transpose_half([a[0], b[0], c[0], d[0]]);
        let high = self.transpose_half([a[1], b[1], c[1], d[1]]);
        [
            [low[0], high[0]],
            [low[1], high[1]],
            [low[2], high[2]],
            [low[3], high[3]],
        ]
    }
}
