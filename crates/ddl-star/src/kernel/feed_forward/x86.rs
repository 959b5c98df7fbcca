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

use super::simd::{Kernel, Simd};
use super::{BLOCK, Block};

/// The proof that the processor has AVX2 and fused multiplication.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Avx2(());

/// The proof that the processor has AVX-512 F.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Avx512(());

/// Methods that are one expression of instructions of the set each.
macro_rules! instructions {
    ($(fn $name:ident$(<const $n:ident: u32>)?($($argument:ident: $kind:ty),*) -> $result:ty = $value:expr;)*) => {$(
        #[inline(always)]
        fn $name$(<const $n: u32>)?(self, $($argument: $kind),*) -> $result {
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
    type Floats = __m256;
    type Bits = __m256i;
    const WIDTH: usize = 8;

    #[inline]
    fn run<K: Kernel>(self, kernel: K) -> K::Output {
        #[target_feature(enable = "avx2,fma")]
        fn compiled<K: Kernel>(simd: Avx2, kernel: K) -> K::Output {
            kernel.run::<_, 4, 2>(simd)
        }
        // SAFETY: `self` is the proof that the processor has the instructions.
        unsafe { compiled(self, kernel) }
    }

    instructions! {
        fn splat(value: f32) -> __m256 = _mm256_set1_ps(value);
        fn add(a: __m256, b: __m256) -> __m256 = _mm256_add_ps(a, b);
        fn mul(a: __m256, b: __m256) -> __m256 = _mm256_mul_ps(a, b);
        fn mul_add(a: __m256, b: __m256, c: __m256) -> __m256 = _mm256_fmadd_ps(a, b, c);
        // The second operand is the result when one is NaN.
        fn relu(a: __m256) -> __m256 = _mm256_max_ps(_mm256_setzero_ps(), a);
        fn zero_unless_positive(condition: __m256, a: __m256) -> __m256 =
            _mm256_and_ps(_mm256_cmp_ps::<_CMP_NLE_UQ>(condition, _mm256_setzero_ps()), a);
        fn count_from(first: u32, part: usize) -> __m256i = _mm256_xor_si256(
            _mm256_set1_epi32((first ^ (part * 8) as u32).cast_signed()),
            _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7),
        );
        fn xor(a: __m256i, b: u32) -> __m256i = _mm256_xor_si256(a, _mm256_set1_epi32(b.cast_signed()));
        fn xor_shift<const N: u32>(a: __m256i) -> __m256i =
            _mm256_xor_si256(a, _mm256_srl_epi32(a, _mm_cvtsi32_si128(N.cast_signed())));
        fn shift_left<const N: u32>(a: __m256i) -> __m256i =
            _mm256_sll_epi32(a, _mm_cvtsi32_si128(N.cast_signed()));
        fn mul_low(a: __m256i, b: u32) -> __m256i = _mm256_mullo_epi32(a, _mm256_set1_epi32(b.cast_signed()));
        // There is no comparison of unsigned words: a >= b where their maximum is a.
        fn keep(a: __m256, bits: __m256i, least: u32) -> __m256 = _mm256_and_ps(a, _mm256_castsi256_ps(
            _mm256_cmpeq_epi32(bits, _mm256_max_epu32(bits, _mm256_set1_epi32(least.cast_signed()))),
        ));
    }

    #[inline(always)]
    fn load(self, from: &Block, part: usize) -> __m256 {
        assert!(part < BLOCK / Self::WIDTH);
        // SAFETY: `self` is the proof that the processor has the instruction; part * WIDTH + WIDTH <= BLOCK, and the
        // instruction asks for no alignment.
        unsafe { _mm256_loadu_ps(from.0.as_ptr().add(part * Self::WIDTH)) }
    }

    #[inline(always)]
    fn store(self, value: __m256, into: &mut Block, part: usize) {
        assert!(part < BLOCK / Self::WIDTH);
        // SAFETY: as in `load`.
        unsafe { _mm256_storeu_ps(into.0.as_mut_ptr().add(part * Self::WIDTH), value) }
    }
}

impl Avx512 {
    pub(crate) fn detect() -> Option<Self> {
        is_x86_feature_detected!("avx512f").then_some(Self(()))
    }
}

impl Simd for Avx512 {
    type Floats = __m512;
    type Bits = __m512i;
    const WIDTH: usize = 16;

    #[inline]
    fn run<K: Kernel>(self, kernel: K) -> K::Output {
        #[target_feature(enable = "avx512f")]
        fn compiled<K: Kernel>(simd: Avx512, kernel: K) -> K::Output {
            kernel.run::<_, 8, 2>(simd)
        }
        // SAFETY: `self` is the proof that the processor has the instructions.
        unsafe { compiled(self, kernel) }
    }

    instructions! {
        fn splat(value: f32) -> __m512 = _mm512_set1_ps(value);
        fn add(a: __m512, b: __m512) -> __m512 = _mm512_add_ps(a, b);
        fn mul(a: __m512, b: __m512) -> __m512 = _mm512_mul_ps(a, b);
        fn mul_add(a: __m512, b: __m512, c: __m512) -> __m512 = _mm512_fmadd_ps(a, b, c);
        // The second operand is the result when one is NaN.
        fn relu(a: __m512) -> __m512 = _mm512_max_ps(_mm512_setzero_ps(), a);
        fn zero_unless_positive(condition: __m512, a: __m512) -> __m512 =
            _mm512_maskz_mov_ps(_mm512_cmp_ps_mask::<_CMP_NLE_UQ>(condition, _mm512_setzero_ps()), a);
        fn count_from(first: u32, part: usize) -> __m512i = _mm512_xor_si512(
            _mm512_set1_epi32((first ^ (part * 16) as u32).cast_signed()),
            _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15),
        );
        fn xor(a: __m512i, b: u32) -> __m512i = _mm512_xor_si512(a, _mm512_set1_epi32(b.cast_signed()));
        fn xor_shift<const N: u32>(a: __m512i) -> __m512i = _mm512_xor_si512(a, _mm512_srli_epi32::<N>(a));
        fn shift_left<const N: u32>(a: __m512i) -> __m512i = _mm512_slli_epi32::<N>(a);
        fn mul_low(a: __m512i, b: u32) -> __m512i = _mm512_mullo_epi32(a, _mm512_set1_epi32(b.cast_signed()));
        fn keep(a: __m512, bits: __m512i, least: u32) -> __m512 =
            _mm512_maskz_mov_ps(_mm512_cmpge_epu32_mask(bits, _mm512_set1_epi32(least.cast_signed())), a);
    }

    #[inline(always)]
    fn load(self, from: &Block, part: usize) -> __m512 {
        assert!(part < BLOCK / Self::WIDTH);
        // SAFETY: `self` is the proof that the processor has the instruction; part * WIDTH + WIDTH <= BLOCK, and the
        // instruction asks for no alignment.
        unsafe { _mm512_loadu_ps(from.0.as_ptr().add(part * Self::WIDTH)) }
    }

    #[inline(always)]
    fn store(self, value: __m512, into: &mut Block, part: usize) {
        assert!(part < BLOCK / Self::WIDTH);
        // SAFETY: as in `load`.
        unsafe { _mm512_storeu_ps(into.0.as_mut_ptr().add(part * Self::WIDTH), value) }
    }
}
