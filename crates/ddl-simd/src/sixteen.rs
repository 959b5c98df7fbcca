//! Sixteen numbers in as many registers as needed.

#![expect(clippy::inline_always, reason = "the lanes must stay in registers")]

use crate::exp2::vanishing;
use crate::lanes::{HALF, LANES};
use crate::register::Register;
use crate::simd::{Simd, TiledKernel, Vectors};

#[derive(Clone, Copy, Debug)]
pub(crate) struct Sixteen<R, const P: usize>(pub(crate) R);

/// Methods that apply the same operation to each part of their first argument. A loop, because the call that `map`
/// makes is not always inlined.
macro_rules! part_by_part {
    ($(fn $name:ident$(<const $n:ident: $constant:ty>)?(
        $a:ident: $kind:ident$(, $b:ident: $other:ident)*; $($c:ident: $scalar:ty),*
    );)*) => {$(
        #[inline(always)]
        fn $name$(<const $n: $constant>)?(
            self, $a: Self::$kind, $($b: Self::$other,)* $($c: $scalar),*
        ) -> Self::$kind {
            let mut result = $a;
            for p in 0..P {
                result[p] = self.0.$name$(::<$n>)?($a[p], $($b[p],)* $($c),*);
            }
            result
        }
    )*};
}

impl<R: Register, const P: usize> Simd for Sixteen<R, P> {
    type Floats = [R::Floats; P];
    type Bits = [R::Bits; P];

    #[inline(always)]
    fn run_tiled<K: TiledKernel>(self, kernel: K) {
        self.0.run_tiled(kernel);
    }

    #[inline(always)]
    fn splat(self, value: f32) -> Self::Floats {
        [self.0.splat(value); P]
    }

    #[inline(always)]
    fn load(self, from: &[f32; LANES]) -> Self::Floats {
        let mut result = self.splat(0.0);
        for (p, part) in result.iter_mut().enumerate() {
            *part = self.0.load(from, p);
        }
        result
    }

    #[inline(always)]
    fn store(self, value: Self::Floats, into: &mut [f32; LANES]) {
        for (p, part) in value.into_iter().enumerate() {
            self.0.store(part, into, p);
        }
    }

    #[inline(always)]
    fn load_halves(self, low: &[f32; HALF], high: &[f32; HALF]) -> Self::Floats {
        let mut result = self.splat(0.0);
        for (p, part) in result.iter_mut().enumerate() {
            *part = self.0.load_halves([low, high], p);
        }
        result
    }

    #[inline(always)]
    fn store_halves(self, value: Self::Floats, low: &mut [f32; HALF], high: &mut [f32; HALF]) {
        for (p, part) in value.into_iter().enumerate() {
            self.0.store_halves(part, [low, high], p);
        }
    }

    #[inline(always)]
    fn prefetch(self, number: &f32) {
        self.0.prefetch(number);
    }

    part_by_part! {
        fn add(a: Floats, b: Floats;);
        fn sub(a: Floats, b: Floats;);
        fn mul(a: Floats, b: Floats;);
        fn div(a: Floats, b: Floats;);
        fn sqrt(a: Floats;);
        fn max(a: Floats, b: Floats;);
        fn min(a: Floats, b: Floats;);
        fn where_at_least(a: Floats, b: Floats, taken: Floats, other: Floats;);
        fn mul_add(a: Floats, b: Floats, c: Floats;);
        fn zero_unless_positive(condition: Floats, a: Floats;);
        fn spread<const FROM: i32>(a: Floats;);
        fn xor(a: Bits; b: u32);
        fn xor_shift<const N: u32>(a: Bits;);
        fn shift_left<const N: u32>(a: Bits;);
        fn mul_low(a: Bits; b: u32);
        fn keep(a: Floats, bits: Bits; least: u32);
    }

    #[inline(always)]
    fn at_least(self, a: Self::Floats, b: Self::Floats) -> u32 {
        let mut mask = 0;
        for p in 0..P {
            mask |= self.0.at_least(a[p], b[p]) << (p * R::WIDTH);
        }
        mask
    }

    #[inline(always)]
    fn exp2(self, exponent: Self::Floats) -> Self::Floats {
        vanishing(self.0, exponent)
    }

    #[inline(always)]
    fn transpose(self, groups: Vectors<Self>) -> Vectors<Self> {
        let mut result = groups;
        for p in 0..P {
            let [a, b, c, d] = self
                .0
                .transpose([groups[0][p], groups[1][p], groups[2][p], groups[3][p]]);
            result[0][p] = a;
            result[1][p] = b;
            result[2][p] = c;
            result[3][p] = d;
        }
        result
    }

    #[inline(always)]
    fn sum_of_quarters(self, a: Self::Floats) -> Self::Floats {
        let mut sum = a;
        let mut parts = P / 2;
        while parts > 0 {
            for p in 0..parts {
                sum[p] = self.0.add(sum[p], sum[p + parts]);
            }
            parts /= 2;
        }
        [self.0.sum_of_fours(sum[0]); P]
    }

    #[inline(always)]
    fn count_from(self, first: u32) -> Self::Bits {
        let mut bits = [self.0.count_from(first); P];
        for p in 1..P {
            bits[p] = self.0.xor(bits[0], (p * R::WIDTH) as u32);
        }
        bits
    }
}
