//! Vector instructions of x86-64 processors: the only unsafe code of the crate.
//!
//! [`Avx2`] and [`Avx512`] are only created by their `detect`, which queries the processor. So a value of these types
//! proves that the processor has the instructions.

#![allow(
    unsafe_code,
    reason = "instructions that not every processor has, and loads and stores through pointers"
)]
#![expect(clippy::inline_always, reason = "the lanes must stay in registers")]
#![allow(clippy::wildcard_imports, reason = "the names of instructions show their origin")]

use std::arch::x86_64::*;

use crate::exp2::{COST_LIMIT, UPWARD_POLYNOMIAL, WIDE_ROUNDING, normal};
use crate::lanes::{HALF, LANES, WIDE_LANES};
use crate::register::{Register, RegisterKernel};
use crate::simd::TiledKernel;
use crate::sixteen::Sixteen;

/// The proof that the processor has AVX2 and fused multiplication.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Avx2(());

/// The proof that the processor has AVX-512 F and DQ, beside AVX2.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Avx512(());

impl Avx2 {
    pub(crate) fn detect() -> Option<Self> {
        let found = is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma");
        found.then_some(Self(()))
    }
}

impl Avx512 {
    /// Includes the instructions of AVX2, which inlined code may use.
    pub(crate) fn detect() -> Option<Self> {
        let found = is_x86_feature_detected!("avx512f") && is_x86_feature_detected!("avx512dq");
        Avx2::detect().filter(|_| found).map(|_| Self(()))
    }
}

/// Methods that consist of one expression of intrinsics each.
macro_rules! instructions {
    ($(fn $name:ident$(<const $n:ident: $constant:ty>)?($($argument:ident: $kind:ty),*)
        -> $result:ty = $value:expr;)*) => {$(
        #[inline(always)]
        fn $name$(<const $n: $constant>)?(self, $($argument: $kind),*) -> $result {
            // SAFETY: `self` is the proof that the processor has the instructions. They access no memory, except whole
            // arrays without a requirement on alignment. A prefetch may name any address.
            unsafe { $value }
        }
    )*};
}

macro_rules! memory {
    ($($load:ident, $store:ident: $value:ty = [$number:ty; $lanes:expr], $load_from:ident, $store_to:ident;)*) => {$(
        #[inline(always)]
        fn $load(self, from: &[$number; $lanes], part: usize) -> $value {
            assert!(part < Self::PARTS);
            // SAFETY: `self` is the proof that the processor has the instruction; PARTS registers are as long as the
            // array, and the instruction requires no alignment.
            unsafe { $load_from(from.as_ptr().add(part * ($lanes / Self::PARTS))) }
        }

        #[inline(always)]
        fn $store(self, value: $value, into: &mut [$number; $lanes], part: usize) {
            assert!(part < Self::PARTS);
            // SAFETY: as in the load.
            unsafe { $store_to(into.as_mut_ptr().add(part * ($lanes / Self::PARTS)), value) }
        }
    )*};
}

impl Register for Avx512 {
    type Floats = __m512;
    type Bits = __m512i;
    type Wide = __m512d;
    type Sixteen = Sixteen<Self, 1>;
    const WIDTH: usize = 16;
    const FUSED: bool = true;

    #[inline]
    fn run<K: RegisterKernel>(self, kernel: K) -> K::Output {
        #[target_feature(enable = "avx2,fma,avx512f,avx512dq")]
        fn compiled<K: RegisterKernel>(register: Avx512, kernel: K) -> K::Output {
            kernel.run(register)
        }
        // SAFETY: `self` is the proof that the processor has the instructions.
        unsafe { compiled(self, kernel) }
    }

    #[inline(always)]
    fn sixteen(self) -> Self::Sixteen {
        Sixteen(self)
    }

    #[inline(always)]
    fn run_tiled<K: TiledKernel>(self, kernel: K) {
        kernel.run::<Self::Sixteen, 8, 2>(Sixteen(self));
    }

    memory! {
        load, store: __m512 = [f32; LANES], _mm512_loadu_ps, _mm512_storeu_ps;
        wide_load, wide_store: __m512d = [f64; WIDE_LANES], _mm512_loadu_pd, _mm512_storeu_pd;
    }

    #[inline(always)]
    fn load_halves(self, [low, high]: [&[f32; HALF]; 2], _part: usize) -> __m512 {
        // SAFETY: `self` is the proof that the processor has the instructions; the arrays fill a register of half the
        // width each, and the loads require no alignment.
        unsafe {
            let low = _mm512_castps256_ps512(_mm256_loadu_ps(low.as_ptr()));
            _mm512_insertf32x8::<1>(low, _mm256_loadu_ps(high.as_ptr()))
        }
    }

    #[inline(always)]
    fn store_halves(self, value: __m512, [low, high]: [&mut [f32; HALF]; 2], _part: usize) {
        // SAFETY: as in the load.
        unsafe {
            _mm256_storeu_ps(low.as_mut_ptr(), _mm512_castps512_ps256(value));
            _mm256_storeu_ps(high.as_mut_ptr(), _mm512_extractf32x8_ps::<1>(value));
        }
    }

    instructions! {
        fn prefetch(number: &f32) -> () = _mm_prefetch::<_MM_HINT_T0>(std::ptr::from_ref(number).cast());
        fn splat(value: f32) -> __m512 = _mm512_set1_ps(value);
        fn add(a: __m512, b: __m512) -> __m512 = _mm512_add_ps(a, b);
        fn sub(a: __m512, b: __m512) -> __m512 = _mm512_sub_ps(a, b);
        fn mul(a: __m512, b: __m512) -> __m512 = _mm512_mul_ps(a, b);
        fn div(a: __m512, b: __m512) -> __m512 = _mm512_div_ps(a, b);
        fn sqrt(a: __m512) -> __m512 = _mm512_sqrt_ps(a);
        // The second operand is the result if one is NaN.
        fn max(a: __m512, b: __m512) -> __m512 = _mm512_max_ps(a, b);
        fn min(a: __m512, b: __m512) -> __m512 = _mm512_min_ps(a, b);
        fn mul_add(a: __m512, b: __m512, c: __m512) -> __m512 = _mm512_fmadd_ps(a, b, c);
        fn neg_mul_add(a: __m512, b: __m512, c: __m512) -> __m512 = _mm512_fnmadd_ps(a, b, c);
        fn at_least(a: __m512, b: __m512) -> u32 = u32::from(_mm512_cmp_ps_mask::<_CMP_GE_OQ>(a, b));
        fn where_at_least(a: __m512, b: __m512, taken: __m512, other: __m512) -> __m512 =
            _mm512_mask_blend_ps(_mm512_cmp_ps_mask::<_CMP_GE_OQ>(a, b), other, taken);
        fn zero_unless_positive(condition: __m512, a: __m512) -> __m512 =
            _mm512_maskz_mov_ps(_mm512_cmp_ps_mask::<_CMP_NLE_UQ>(condition, _mm512_setzero_ps()), a);
        fn scale(power: __m512, exponent: __m512) -> __m512 = _mm512_castsi512_ps(_mm512_add_epi32(
            _mm512_castps_si512(power),
            _mm512_slli_epi32::<23>(_mm512_castps_si512(exponent)),
        ));
        fn spread<const FROM: i32>(a: __m512) -> __m512 = _mm512_permute_ps::<FROM>(a);
        fn sum_of_fours(a: __m512) -> __m512 = {
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

        fn wide_splat(value: f64) -> __m512d = _mm512_set1_pd(value);
        fn wide_add(a: __m512d, b: __m512d) -> __m512d = _mm512_add_pd(a, b);
        fn wide_sub(a: __m512d, b: __m512d) -> __m512d = _mm512_sub_pd(a, b);
        fn wide_mul(a: __m512d, b: __m512d) -> __m512d = _mm512_mul_pd(a, b);
        fn wide_mul_add(a: __m512d, b: __m512d, c: __m512d) -> __m512d = _mm512_fmadd_pd(a, b, c);
        fn wide_max(a: __m512d, b: __m512d) -> __m512d = _mm512_max_pd(a, b);
        fn wide_min(a: __m512d, b: __m512d) -> __m512d = _mm512_min_pd(a, b);
        fn wide_sqrt(a: __m512d) -> __m512d = _mm512_sqrt_pd(a);
        fn wide_opposite(a: __m512d, bits: u64) -> __m512d = _mm512_castsi512_pd(_mm512_sub_epi64(
            _mm512_set1_epi64(bits.cast_signed()),
            _mm512_castpd_si512(a),
        ));
        fn wide_zero_unless_above(a: __m512d, limit: __m512d) -> __m512d =
            _mm512_maskz_mov_pd(_mm512_cmp_pd_mask::<_CMP_GT_OQ>(a, limit), a);
        fn wide_split(a: __m512d) -> (__m512d, __m512d) = {
            let rest = _mm512_reduce_pd::<_MM_FROUND_TO_NEAREST_INT>(a);
            (_mm512_sub_pd(a, rest), rest)
        };
        fn wide_scale_far(number: __m512d, exponent: __m512d) -> __m512d = _mm512_castsi512_pd(_mm512_add_epi64(
            _mm512_castpd_si512(number),
            _mm512_slli_epi64::<52>(_mm512_castpd_si512(_mm512_add_pd(exponent, _mm512_set1_pd(WIDE_ROUNDING)))),
        ));
        // This instruction is slow where the product is below the normal numbers.
        fn wide_scale(number: __m512d, exponent: __m512d) -> __m512d = _mm512_scalef_pd(number, exponent);
    }

    #[inline(always)]
    fn wide_below(self, lanes: &[f64; WIDE_LANES], first: f64) -> [f64; WIDE_LANES] {
        let mut moved = [0.0; WIDE_LANES];
        self.wide_store(
            self.shifted::<7>(self.wide_splat(first), self.wide_load(lanes, 0)),
            &mut moved,
            0,
        );
        moved
    }

    #[inline(always)]
    fn wide_above(self, lanes: &[f64; WIDE_LANES], last: f64) -> [f64; WIDE_LANES] {
        let mut moved = [0.0; WIDE_LANES];
        self.wide_store(
            self.shifted::<1>(self.wide_load(lanes, 0), self.wide_splat(last)),
            &mut moved,
            0,
        );
        moved
    }

    /// Computes f = exponent − floor(exponent) with one instruction, and scales the power with another.
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
}

impl Avx512 {
    instructions! {
        // The lanes from `N` on of `low` followed by `high`.
        fn shifted<const N: i32>(low: __m512d, high: __m512d) -> __m512d = _mm512_castsi512_pd(
            _mm512_alignr_epi64::<N>(_mm512_castpd_si512(high), _mm512_castpd_si512(low)),
        );
        fn above_floor(a: __m512) -> __m512 = _mm512_reduce_ps::<{ _MM_FROUND_FLOOR }>(a);
        fn scale_by_floor(power: __m512, exponent: __m512) -> __m512 = _mm512_scalef_ps(power, exponent);
    }
}

impl Register for Avx2 {
    type Floats = __m256;
    type Bits = __m256i;
    type Wide = __m256d;
    type Sixteen = Sixteen<Self, 2>;
    const WIDTH: usize = 8;
    const FUSED: bool = true;

    #[inline]
    fn run<K: RegisterKernel>(self, kernel: K) -> K::Output {
        #[target_feature(enable = "avx2,fma")]
        fn compiled<K: RegisterKernel>(register: Avx2, kernel: K) -> K::Output {
            kernel.run(register)
        }
        // SAFETY: `self` is the proof that the processor has the instructions.
        unsafe { compiled(self, kernel) }
    }

    #[inline(always)]
    fn sixteen(self) -> Self::Sixteen {
        Sixteen(self)
    }

    #[inline(always)]
    fn run_tiled<K: TiledKernel>(self, kernel: K) {
        kernel.run::<Self::Sixteen, 4, 1>(Sixteen(self));
    }

    memory! {
        load, store: __m256 = [f32; LANES], _mm256_loadu_ps, _mm256_storeu_ps;
        wide_load, wide_store: __m256d = [f64; WIDE_LANES], _mm256_loadu_pd, _mm256_storeu_pd;
    }

    #[inline(always)]
    fn load_halves(self, from: [&[f32; HALF]; 2], part: usize) -> __m256 {
        // SAFETY: `self` is the proof that the processor has the instruction; an array fills a register, and the load
        // requires no alignment.
        unsafe { _mm256_loadu_ps(from[part].as_ptr()) }
    }

    #[inline(always)]
    fn store_halves(self, value: __m256, into: [&mut [f32; HALF]; 2], part: usize) {
        // SAFETY: as in the load.
        unsafe { _mm256_storeu_ps(into[part].as_mut_ptr(), value) }
    }

    instructions! {
        fn prefetch(number: &f32) -> () = _mm_prefetch::<_MM_HINT_T0>(std::ptr::from_ref(number).cast());
        fn splat(value: f32) -> __m256 = _mm256_set1_ps(value);
        fn add(a: __m256, b: __m256) -> __m256 = _mm256_add_ps(a, b);
        fn sub(a: __m256, b: __m256) -> __m256 = _mm256_sub_ps(a, b);
        fn mul(a: __m256, b: __m256) -> __m256 = _mm256_mul_ps(a, b);
        fn div(a: __m256, b: __m256) -> __m256 = _mm256_div_ps(a, b);
        fn sqrt(a: __m256) -> __m256 = _mm256_sqrt_ps(a);
        // The second operand is the result if one is NaN.
        fn max(a: __m256, b: __m256) -> __m256 = _mm256_max_ps(a, b);
        fn min(a: __m256, b: __m256) -> __m256 = _mm256_min_ps(a, b);
        fn mul_add(a: __m256, b: __m256, c: __m256) -> __m256 = _mm256_fmadd_ps(a, b, c);
        fn neg_mul_add(a: __m256, b: __m256, c: __m256) -> __m256 = _mm256_fnmadd_ps(a, b, c);
        fn at_least(a: __m256, b: __m256) -> u32 =
            _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_GE_OQ>(a, b)).cast_unsigned();
        fn where_at_least(a: __m256, b: __m256, taken: __m256, other: __m256) -> __m256 =
            _mm256_blendv_ps(other, taken, _mm256_cmp_ps::<_CMP_GE_OQ>(a, b));
        fn zero_unless_positive(condition: __m256, a: __m256) -> __m256 =
            _mm256_and_ps(_mm256_cmp_ps::<_CMP_NLE_UQ>(condition, _mm256_setzero_ps()), a);
        fn scale(power: __m256, exponent: __m256) -> __m256 = _mm256_castsi256_ps(_mm256_add_epi32(
            _mm256_castps_si256(power),
            _mm256_slli_epi32::<23>(_mm256_castps_si256(exponent)),
        ));
        fn spread<const FROM: i32>(a: __m256) -> __m256 = _mm256_permute_ps::<FROM>(a);
        fn sum_of_fours(a: __m256) -> __m256 = _mm256_add_ps(a, _mm256_permute2f128_ps::<1>(a, a));
        fn transpose(groups: [__m256; 4]) -> [__m256; 4] = {
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

        fn count_from(first: u32) -> __m256i = _mm256_xor_si256(
            _mm256_set1_epi32(first.cast_signed()),
            _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7),
        );
        fn xor(a: __m256i, b: u32) -> __m256i = _mm256_xor_si256(a, _mm256_set1_epi32(b.cast_signed()));
        fn xor_shift<const N: u32>(a: __m256i) -> __m256i =
            _mm256_xor_si256(a, _mm256_srl_epi32(a, _mm_cvtsi32_si128(N.cast_signed())));
        fn shift_left<const N: u32>(a: __m256i) -> __m256i =
            _mm256_sll_epi32(a, _mm_cvtsi32_si128(N.cast_signed()));
        fn mul_low(a: __m256i, b: u32) -> __m256i = _mm256_mullo_epi32(a, _mm256_set1_epi32(b.cast_signed()));
        // AVX2 has no comparison of unsigned words: a >= b where their maximum is a.
        fn keep(a: __m256, bits: __m256i, least: u32) -> __m256 = _mm256_and_ps(a, _mm256_castsi256_ps(
            _mm256_cmpeq_epi32(bits, _mm256_max_epu32(bits, _mm256_set1_epi32(least.cast_signed())))
        ));

        fn wide_splat(value: f64) -> __m256d = _mm256_set1_pd(value);
        fn wide_add(a: __m256d, b: __m256d) -> __m256d = _mm256_add_pd(a, b);
        fn wide_sub(a: __m256d, b: __m256d) -> __m256d = _mm256_sub_pd(a, b);
        fn wide_mul(a: __m256d, b: __m256d) -> __m256d = _mm256_mul_pd(a, b);
        fn wide_mul_add(a: __m256d, b: __m256d, c: __m256d) -> __m256d = _mm256_fmadd_pd(a, b, c);
        fn wide_max(a: __m256d, b: __m256d) -> __m256d = _mm256_max_pd(a, b);
        fn wide_min(a: __m256d, b: __m256d) -> __m256d = _mm256_min_pd(a, b);
        fn wide_sqrt(a: __m256d) -> __m256d = _mm256_sqrt_pd(a);
        fn wide_opposite(a: __m256d, bits: u64) -> __m256d = _mm256_castsi256_pd(_mm256_sub_epi64(
            _mm256_set1_epi64x(bits.cast_signed()),
            _mm256_castpd_si256(a),
        ));
        fn wide_zero_unless_above(a: __m256d, limit: __m256d) -> __m256d =
            _mm256_and_pd(_mm256_cmp_pd::<_CMP_GT_OQ>(a, limit), a);
        fn wide_split(a: __m256d) -> (__m256d, __m256d) = {
            let rounding = _mm256_set1_pd(WIDE_ROUNDING);
            let integer = _mm256_sub_pd(_mm256_add_pd(a, rounding), rounding);
            (integer, _mm256_sub_pd(a, integer))
        };
        // The integer is in the low bits of the sum; added to the bits of the exponent it multiplies by 2^integer.
        fn wide_scale_far(number: __m256d, exponent: __m256d) -> __m256d = _mm256_castsi256_pd(_mm256_add_epi64(
            _mm256_castpd_si256(number),
            _mm256_slli_epi64::<52>(_mm256_castpd_si256(_mm256_add_pd(exponent, _mm256_set1_pd(WIDE_ROUNDING)))),
        ));
    }

    #[inline(always)]
    fn exp2_each<const G: usize>(self, exponents: [__m256; G]) -> [__m256; G] {
        normal(self, exponents)
    }
}
