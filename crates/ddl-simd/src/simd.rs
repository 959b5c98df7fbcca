//! Arithmetic on sixteen numbers, and traits of the computations that use it.

#![expect(clippy::inline_always, reason = "the lanes must stay in registers")]

use crate::exp2::exp2_each;
use crate::lanes::{DEPTH, LANES};
use fearless_simd::prelude::*;
use fearless_simd::{f32x4, f32x8, f32x16, mask32x16, u32x16};

/// Sixteen numbers.
pub type Floats<S> = f32x16<S>;
/// Four times sixteen numbers.
pub type Vectors<S> = [Floats<S>; DEPTH];

/// Smallest exponent whose [`Simd::exp2`] is not 0. Products of such a power and a number of at least 2^−30 are normal;
/// an operation on denormal numbers takes a hundred cycles.
const VANISHING_FROM: f32 = -96.0;

/// Arithmetic on sixteen numbers at a time, in one or more registers.
///
/// A value that implements this trait proves that the machine has the instructions.
///
/// The operators and the methods of `fearless_simd` do the arithmetic.
///
/// # Numerics
/// Every operation is rounded once to the nearest `f32`, except `mul_add`, which the baseline of x86-64 rounds twice.
pub trait Simd: fearless_simd::Simd {
    /// Runs `kernel` from within another kernel, with the number of accumulators that fits the registers.
    #[inline(always)]
    fn run_tiled<K: TiledKernel>(self, kernel: K) {
        match <Self::f32s as SimdBase<Self>>::LEN {
            16 => kernel.run::<Self, 8, 2>(self),
            8 => kernel.run::<Self, 4, 1>(self),
            // The accumulators fill half of the sixteen registers of most machines.
            _ => kernel.run::<Self, 2, 1>(self),
        }
    }

    /// `value` in every lane.
    #[inline(always)]
    fn splat(self, value: f32) -> Floats<Self> {
        Floats::splat(self, value)
    }

    /// The numbers of an array.
    #[inline(always)]
    fn load(self, from: &[f32; LANES]) -> Floats<Self> {
        Floats::load_array_ref(self, from)
    }

    /// Writes the numbers to an array.
    #[inline(always)]
    fn store(self, value: Floats<Self>, into: &mut [f32; LANES]) {
        value.store_array(into);
    }

    /// The numbers of two arrays in the lower and in the upper lanes.
    #[inline(always)]
    fn load_halves(self, low: &[f32; LANES / 2], high: &[f32; LANES / 2]) -> Floats<Self> {
        f32x8::load_array_ref(self, low).combine(f32x8::load_array_ref(self, high))
    }

    /// Writes the lower and the upper lanes to two arrays.
    #[inline(always)]
    fn store_halves(self, value: Floats<Self>, low: &mut [f32; LANES / 2], high: &mut [f32; LANES / 2]) {
        let (lower, upper) = value.split();
        lower.store_array(low);
        upper.store_array(high);
    }

    /// Asks the processor to load the cache line of this number soon. Does nothing where no instruction does that.
    #[inline(always)]
    fn prefetch(self, number: &f32) {
        #[cfg(target_arch = "x86_64")]
        if let Some(sse2) = self.level().as_sse2() {
            prefetch_line(sse2, number);
        }
        #[cfg(not(target_arch = "x86_64"))]
        let _ = number;
    }

    /// 2^`exponent` for exponents that are not positive; exactly 0 below −96 and for NaN.
    ///
    /// # Numerics
    /// The relative error is below 3e-7 down to −96, and the result is exactly 1 at 0.
    #[inline(always)]
    fn exp2(self, exponent: Floats<Self>) -> Floats<Self> {
        let vanishing = self.splat(-127.0);
        let [power] = exp2_each(self, [exponent.simd_ge(VANISHING_FROM).select(exponent, vanishing)]);
        power
    }

    /// Lane 4 i + j of group k becomes lane 4 i + k of group j. The operation is its own inverse.
    #[inline(always)]
    fn transpose(self, [a, b, c, d]: Vectors<Self>) -> Vectors<Self> {
        let (a, b) = exchanged::<Self, 1, 3>(self, a, b);
        let (c, d) = exchanged::<Self, 1, 3>(self, c, d);
        let (a, c) = exchanged::<Self, 2, 2>(self, a, c);
        let (b, d) = exchanged::<Self, 2, 2>(self, b, d);
        [a, b, c, d]
    }

    /// Lane 4 i + j of vector k is lane 4 i + k of `a`.
    #[inline(always)]
    fn spread_each(self, a: Floats<Self>) -> Vectors<Self> {
        let quarters = quarters(a);
        let mut spread = [quarters; DEPTH];
        for (i, quarter) in quarters.into_iter().enumerate() {
            let (low, high) = (quarter.zip_low(quarter), quarter.zip_high(quarter));
            spread[0][i] = low.zip_low(low);
            spread[1][i] = low.zip_high(low);
            spread[2][i] = high.zip_low(high);
            spread[3][i] = high.zip_high(high);
        }
        let [a, b, c, d] = spread;
        [combined(a), combined(b), combined(c), combined(d)]
    }

    /// Lane 4 i + j of the result is the sum of the lanes 4 k + j of `a` over k, (0 + 2) + (1 + 3).
    #[inline(always)]
    fn sum_of_quarters(self, a: Floats<Self>) -> Floats<Self> {
        let (lower, upper) = a.split();
        let (lower, upper) = (lower + upper).split();
        combined([lower + upper; DEPTH])
    }

    /// Lane l is `first` xor l.
    #[inline(always)]
    fn count_from(self, first: u32) -> u32x16<Self> {
        u32x16::load_array(self, [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15]) ^ first
    }

    /// `a` where `bits` >= `least`, 0 elsewhere.
    #[inline(always)]
    fn keep(self, a: Floats<Self>, bits: u32x16<Self>, least: u32) -> Floats<Self> {
        bits.simd_ge(least).select(a, self.splat(0.0))
    }
}

impl<S: fearless_simd::Simd> Simd for S {}

#[cfg(target_arch = "x86_64")]
fearless_simd::kernel!(
    #[inline(always)]
    fn prefetch_line(_simd: Sse2, number: &f32) {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        _mm_prefetch::<_MM_HINT_T0>(std::ptr::from_ref(number).cast());
    }
);

/// Exchanges the lanes of `a` whose number has the bit `N` with the lanes of `b` that do not have it, within groups of
/// four. `BACK` is 4 − `N`.
#[inline(always)]
fn exchanged<S: Simd, const N: usize, const BACK: usize>(
    simd: S,
    a: Floats<S>,
    b: Floats<S>,
) -> (Floats<S>, Floats<S>) {
    let has_bit = mask32x16::from_bitmask(simd, if N == 1 { 0xaaaa } else { 0xcccc });
    let (up, down) = (b.slide_within_blocks::<BACK>(b), a.slide_within_blocks::<N>(a));
    (has_bit.select(up, a), has_bit.select(b, down))
}

/// The four groups of four lanes.
#[inline(always)]
fn quarters<S: Simd>(a: Floats<S>) -> [f32x4<S>; DEPTH] {
    let (lower, upper) = a.split();
    let ((a, b), (c, d)) = (lower.split(), upper.split());
    [a, b, c, d]
}

#[inline(always)]
fn combined<S: Simd>([a, b, c, d]: [f32x4<S>; DEPTH]) -> Floats<S> {
    a.combine(b).combine(c.combine(d))
}

/// A computation that is compiled once for each instruction set.
///
/// `run` must be `#[inline(always)]`, and so must everything it calls with vectors. Code that is not inlined, including
/// closures, is not compiled for the instruction set.
pub trait Kernel {
    /// The computation.
    fn run<S: Simd>(self, simd: S);
}

/// A [`Kernel`] for matrix products, written for accumulators of `R` rows and `V` vectors.
///
/// The instruction set determines how many accumulators fit its registers: `R` divides 8, `V` is 1 or 2. The rules of
/// [`Kernel`] apply.
pub trait TiledKernel {
    /// The computation.
    fn run<S: Simd, const R: usize, const V: usize>(self, simd: S);
}

impl<K: TiledKernel> Kernel for K {
    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        simd.run_tiled(self);
    }
}
