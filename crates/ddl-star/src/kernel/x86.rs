//! Vector instructions of x86-64 processors: the only unsafe code of the kernels.
//!
//! [`Avx2`], [`Avx512`] and [`Avx512Bf16`] can be made by their `detect` alone, which asks the processor: whoever holds one may execute
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
use super::simd::{Kernel, PairKernel, Pairs, Simd, TiledKernel};

/// The proof that the processor has AVX2 and fused multiplication.
#[derive(Clone, Copy, Debug)]
pub(super) struct Avx2(());

/// The proof that the processor has AVX-512 F.
#[derive(Clone, Copy, Debug)]
pub(super) struct Avx512(());

/// The proof that the processor has AVX-512 BF16, beside F and BW.
#[derive(Clone, Copy, Debug)]
pub(super) struct Avx512Bf16(Avx512);

impl Avx2 {
    pub(super) fn detect() -> Option<Self> {
        let found = is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma");
        found.then_some(Self(()))
    }
}

impl Avx512 {
    /// With the instructions of AVX2, which code that is compiled along may use.
    pub(super) fn detect() -> Option<Self> {
        let found = Avx2::detect().is_some() && is_x86_feature_detected!("avx512f");
        found.then_some(Self(()))
    }
}

impl Avx512Bf16 {
    pub(super) fn detect() -> Option<Self> {
        let found = is_x86_feature_detected!("avx512bw") && is_x86_feature_detected!("avx512bf16");
        Avx512::detect().filter(|_| found).map(Self)
    }
}

/// Methods that are one expression of instructions of the set each.
macro_rules! instructions {
    ($(fn $name:ident$(<const $n:ident: $constant:ty>)?($($argument:ident: $kind:ty),*) -> $result:ty = $value:expr;)*) => {$(
        #[inline(always)]
        fn $name$(<const $n: $constant>)?(self, $($argument: $kind),*) -> $result {
            // SAFETY: `self` is the proof that the processor has the instructions. They touch no memory but, without
            // asking for alignment, the sixteen numbers of an array.
            unsafe { $value }
        }
    )*};
}

impl Simd for Avx512 {
    type Floats = __m512;
    type Bits = __m512i;

    #[inline]
    fn run<K: Kernel>(self, kernel: K) {
        #[target_feature(enable = "avx2,fma,avx512f")]
        fn compiled<K: Kernel>(simd: Avx512, kernel: K) {
            kernel.run(simd);
        }
        // SAFETY: `self` is the proof that the processor has the instructions.
        unsafe { compiled(self, kernel) }
    }

    #[inline(always)]
    fn run_tiled<K: TiledKernel>(self, kernel: K) {
        kernel.run::<Self, 8, 2>(self);
    }

    instructions! {
        fn splat(value: f32) -> __m512 = _mm512_set1_ps(value);
        fn load(from: &[f32; LANES]) -> __m512 = _mm512_loadu_ps(from.as_ptr());
        fn store(value: __m512, into: &mut [f32; LANES]) -> () = _mm512_storeu_ps(into.as_mut_ptr(), value);
        fn add(a: __m512, b: __m512) -> __m512 = _mm512_add_ps(a, b);
        fn sub(a: __m512, b: __m512) -> __m512 = _mm512_sub_ps(a, b);
        fn mul(a: __m512, b: __m512) -> __m512 = _mm512_mul_ps(a, b);
        fn div(a: __m512, b: __m512) -> __m512 = _mm512_div_ps(a, b);
        fn sqrt(a: __m512) -> __m512 = _mm512_sqrt_ps(a);
        // The second operand is the result when one is NaN.
        fn max(a: __m512, b: __m512) -> __m512 = _mm512_max_ps(a, b);
        fn mul_add(a: __m512, b: __m512, c: __m512) -> __m512 = _mm512_fmadd_ps(a, b, c);
        fn zero_unless_positive(condition: __m512, a: __m512) -> __m512 =
            _mm512_maskz_mov_ps(_mm512_cmp_ps_mask::<_CMP_NLE_UQ>(condition, _mm512_setzero_ps()), a);
        fn scale(power: __m512, exponent: __m512) -> __m512 = _mm512_castsi512_ps(_mm512_add_epi32(
            _mm512_castps_si512(power),
            _mm512_slli_epi32::<23>(_mm512_castps_si512(exponent)),
        ));
        fn spread<const FROM: i32>(a: __m512) -> __m512 = _mm512_permute_ps::<FROM>(a);
        fn sum_of_quarters(a: __m512) -> __m512 = {
            let halves = _mm512_add_ps(a, _mm512_shuffle_f32x4::<0b01_00_11_10>(a, a));
            _mm512_add_ps(halves, _mm512_shuffle_f32x4::<0b10_11_00_01>(halves, halves))
        };
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

        fn count_from(first: u32) -> __m512i = _mm512_xor_si512(
            _mm512_set1_epi32(first.cast_signed()),
            _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15),
        );
        fn xor(a: __m512i, b: u32) -> __m512i = _mm512_xor_si512(a, _mm512_set1_epi32(b.cast_signed()));
        fn xor_shift<const N: u32>(a: __m512i) -> __m512i = _mm512_xor_si512(a, _mm512_srli_epi32::<N>(a));
        fn shift_left<const N: u32>(a: __m512i) -> __m512i = _mm512_slli_epi32::<N>(a);
        fn mul_low(a: __m512i, b: u32) -> __m512i = _mm512_mullo_epi32(a, _mm512_set1_epi32(b.cast_signed()));
        fn keep(a: __m512, bits: __m512i, least: u32) -> __m512 =
            _mm512_maskz_mov_ps(_mm512_cmpge_epu32_mask(bits, _mm512_set1_epi32(least.cast_signed())), a);
    }
}

impl Pairs for Avx512Bf16 {
    type Simd = Avx512;
    type Words = __m512i;

    #[inline(always)]
    fn simd(self) -> Avx512 {
        self.0
    }

    #[inline]
    fn run_pairs<K: PairKernel>(self, kernel: K) {
        #[target_feature(enable = "avx2,fma,avx512f,avx512bw,avx512bf16")]
        fn compiled<K: PairKernel>(pairs: Avx512Bf16, kernel: K) {
            kernel.run(pairs);
        }
        // SAFETY: `self` is the proof that the processor has the instructions.
        unsafe { compiled(self, kernel) }
    }

    instructions! {
        fn splat(pair: u32) -> __m512i = _mm512_set1_epi32(pair.cast_signed());
        fn load(from: &[u32; LANES]) -> __m512i = _mm512_loadu_epi32(from.as_ptr().cast());
        fn store(value: __m512i, into: &mut [u32; LANES]) -> () =
            _mm512_storeu_epi32(into.as_mut_ptr().cast(), value);
        fn neighbours(a: __m512, b: __m512) -> __m512i = words(_mm512_cvtne2ps_pbh(b, a));
        // Rounded numbers 0 of a and b, which are 0 and 16 of both side by side; then 1 and 17, and so on.
        fn across(a: __m512, b: __m512) -> __m512i = _mm512_permutexvar_epi16(
            _mm512_add_epi32(
                _mm512_mullo_epi32(
                    _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15),
                    _mm512_set1_epi32(0x0001_0001),
                ),
                _mm512_set1_epi32(0x0010_0000),
            ),
            words(_mm512_cvtne2ps_pbh(b, a)),
        );
        fn dot(a: __m512i, b: __m512i, sum: __m512) -> __m512 = _mm512_dpbf16_ps(sum, pairs(a), pairs(b));
    }
}

#[inline(always)]
fn words(pairs: __m512bh) -> __m512i {
    // SAFETY: both are any 512 bits.
    unsafe { std::mem::transmute(pairs) }
}

#[inline(always)]
fn pairs(words: __m512i) -> __m512bh {
    // SAFETY: both are any 512 bits.
    unsafe { std::mem::transmute(words) }
}

/// Lanes 0 to 7, and 8 to 15.
type Floats = [__m256; 2];
type Bits = [__m256i; 2];

/// Applies an expression to the first halves of the arguments and to the second ones.
macro_rules! halves {
    (|$($argument:ident),*| $value:expr) => {[
        { $(let $argument = $argument[0];)* $value },
        { $(let $argument = $argument[1];)* $value },
    ]};
}

impl Simd for Avx2 {
    type Floats = Floats;
    type Bits = Bits;

    #[inline]
    fn run<K: Kernel>(self, kernel: K) {
        #[target_feature(enable = "avx2,fma")]
        fn compiled<K: Kernel>(simd: Avx2, kernel: K) {
            kernel.run(simd);
        }
        // SAFETY: `self` is the proof that the processor has the instructions.
        unsafe { compiled(self, kernel) }
    }

    #[inline(always)]
    fn run_tiled<K: TiledKernel>(self, kernel: K) {
        kernel.run::<Self, 4, 1>(self);
    }

    instructions! {
        fn splat(value: f32) -> Floats = [_mm256_set1_ps(value); 2];
        fn load(from: &[f32; LANES]) -> Floats =
            [_mm256_loadu_ps(from.as_ptr()), _mm256_loadu_ps(from.as_ptr().add(8))];
        fn store(value: Floats, into: &mut [f32; LANES]) -> () = {
            _mm256_storeu_ps(into.as_mut_ptr(), value[0]);
            _mm256_storeu_ps(into.as_mut_ptr().add(8), value[1]);
        };
        fn add(a: Floats, b: Floats) -> Floats = halves!(|a, b| _mm256_add_ps(a, b));
        fn sub(a: Floats, b: Floats) -> Floats = halves!(|a, b| _mm256_sub_ps(a, b));
        fn mul(a: Floats, b: Floats) -> Floats = halves!(|a, b| _mm256_mul_ps(a, b));
        fn div(a: Floats, b: Floats) -> Floats = halves!(|a, b| _mm256_div_ps(a, b));
        fn sqrt(a: Floats) -> Floats = halves!(|a| _mm256_sqrt_ps(a));
        // The second operand is the result when one is NaN.
        fn max(a: Floats, b: Floats) -> Floats = halves!(|a, b| _mm256_max_ps(a, b));
        fn mul_add(a: Floats, b: Floats, c: Floats) -> Floats = halves!(|a, b, c| _mm256_fmadd_ps(a, b, c));
        fn zero_unless_positive(condition: Floats, a: Floats) -> Floats = halves!(|condition, a|
            _mm256_and_ps(_mm256_cmp_ps::<_CMP_NLE_UQ>(condition, _mm256_setzero_ps()), a)
        );
        fn scale(power: Floats, exponent: Floats) -> Floats = halves!(|power, exponent| _mm256_castsi256_ps(
            _mm256_add_epi32(_mm256_castps_si256(power), _mm256_slli_epi32::<23>(_mm256_castps_si256(exponent)))
        ));
        fn spread<const FROM: i32>(a: Floats) -> Floats = halves!(|a| _mm256_permute_ps::<FROM>(a));
        fn sum_of_quarters(a: Floats) -> Floats = {
            let halves = _mm256_add_ps(a[0], a[1]);
            [_mm256_add_ps(halves, _mm256_permute2f128_ps::<1>(halves, halves)); 2]
        };
        fn transpose(groups: [Floats; 4]) -> [Floats; 4] = {
            let [a, b, c, d] = groups;
            let [low, high] = halves!(|a, b, c, d| {
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
            });
            [[low[0], high[0]], [low[1], high[1]], [low[2], high[2]], [low[3], high[3]]]
        };

        fn count_from(first: u32) -> Bits = [
            _mm256_xor_si256(_mm256_set1_epi32(first.cast_signed()), _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7)),
            _mm256_xor_si256(_mm256_set1_epi32(first.cast_signed()), _mm256_setr_epi32(8, 9, 10, 11, 12, 13, 14, 15)),
        ];
        fn xor(a: Bits, b: u32) -> Bits = halves!(|a| _mm256_xor_si256(a, _mm256_set1_epi32(b.cast_signed())));
        fn xor_shift<const N: u32>(a: Bits) -> Bits =
            halves!(|a| _mm256_xor_si256(a, _mm256_srl_epi32(a, _mm_cvtsi32_si128(N.cast_signed()))));
        fn shift_left<const N: u32>(a: Bits) -> Bits =
            halves!(|a| _mm256_sll_epi32(a, _mm_cvtsi32_si128(N.cast_signed())));
        fn mul_low(a: Bits, b: u32) -> Bits = halves!(|a| _mm256_mullo_epi32(a, _mm256_set1_epi32(b.cast_signed())));
        // There is no comparison of unsigned words: a >= b where their maximum is a.
        fn keep(a: Floats, bits: Bits, least: u32) -> Floats = halves!(|a, bits| _mm256_and_ps(a, _mm256_castsi256_ps(
            _mm256_cmpeq_epi32(bits, _mm256_max_epu32(bits, _mm256_set1_epi32(least.cast_signed())))
        )));
    }
}
