//! Sixteen numbers in as many registers as they take.

#![expect(clippy::inline_always, reason = "the lanes must stay in registers")]

use crate::exp2::vanishing;
use crate::lanes::LANES;
use crate::register::Register;
use crate::simd::{Simd, TiledKernel, Vectors};

/// Groups of sixteen numbers in `P` registers each.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sixteen<R, const P: usize>(pub(crate) R);

/// Applies an expression to each part. A loop, not `map`: the call `map` makes is not always inlined.
macro_rules! each_part {
    ($a:ident, |$p:ident| $value:expr) => {{
        let mut result = $a;
        for $p in 0..P {
            result[$p] = $value;
        }
        result
    }};
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
        let zero = self.splat(0.0);
        each_part!(zero, |p| self.0.load(from, p))
    }

    #[inline(always)]
    fn store(self, value: Self::Floats, into: &mut [f32; LANES]) {
        for (p, part) in value.into_iter().enumerate() {
            self.0.store(part, into, p);
        }
    }

    #[inline(always)]
    fn add(self, a: Self::Floats, b: Self::Floats) -> Self::Floats {
        each_part!(a, |p| self.0.add(a[p], b[p]))
    }

    #[inline(always)]
    fn sub(self, a: Self::Floats, b: Self::Floats) -> Self::Floats {
        each_part!(a, |p| self.0.sub(a[p], b[p]))
    }

    #[inline(always)]
    fn mul(self, a: Self::Floats, b: Self::Floats) -> Self::Floats {
        each_part!(a, |p| self.0.mul(a[p], b[p]))
    }

    #[inline(always)]
    fn div(self, a: Self::Floats, b: Self::Floats) -> Self::Floats {
        each_part!(a, |p| self.0.div(a[p], b[p]))
    }

    #[inline(always)]
    fn sqrt(self, a: Self::Floats) -> Self::Floats {
        each_part!(a, |p| self.0.sqrt(a[p]))
    }

    #[inline(always)]
    fn max(self, a: Self::Floats, b: Self::Floats) -> Self::Floats {
        each_part!(a, |p| self.0.max(a[p], b[p]))
    }

    #[inline(always)]
    fn mul_add(self, a: Self::Floats, b: Self::Floats, c: Self::Floats) -> Self::Floats {
        each_part!(a, |p| self.0.mul_add(a[p], b[p], c[p]))
    }

    #[inline(always)]
    fn zero_unless_positive(self, condition: Self::Floats, a: Self::Floats) -> Self::Floats {
        each_part!(a, |p| self.0.zero_unless_positive(condition[p], a[p]))
    }

    #[inline(always)]
    fn exp2(self, exponent: Self::Floats) -> Self::Floats {
        vanishing(self.0, exponent)
    }

    #[inline(always)]
    fn transpose(self, groups: Vectors<Self>) -> Vectors<Self> {
        let mut result = groups;
        for p in 0..P {
            let [a, b, c, d] =
                self.0
                    .transpose([groups[0][p], groups[1][p], groups[2][p], groups[3][p]]);
            result[0][p] = a;
            result[1][p] = b;
            result[2][p] = c;
            result[3][p] = d;
        }
        result
    }

    #[inline(always)]
    fn spread<const FROM: i32>(self, a: Self::Floats) -> Self::Floats {
        each_part!(a, |p| self.0.spread::<FROM>(a[p]))
    }

    #[inline(always)]
    fn sum_of_quarters(self, a: Self::Floats) -> Self::Floats {
        let mut sum = a;
        let mut parts = P;
        while parts > 1 {
            parts /= 2;
            for p in 0..parts {
                sum[p] = self.0.add(sum[p], sum[p + parts]);
            }
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

    #[inline(always)]
    fn xor(self, a: Self::Bits, b: u32) -> Self::Bits {
        each_part!(a, |p| self.0.xor(a[p], b))
    }

    #[inline(always)]
    fn xor_shift<const N: u32>(self, a: Self::Bits) -> Self::Bits {
        each_part!(a, |p| self.0.xor_shift::<N>(a[p]))
    }

    #[inline(always)]
    fn shift_left<const N: u32>(self, a: Self::Bits) -> Self::Bits {
        each_part!(a, |p| self.0.shift_left::<N>(a[p]))
    }

    #[inline(always)]
    fn mul_low(self, a: Self::Bits, b: u32) -> Self::Bits {
        each_part!(a, |p| self.0.mul_low(a[p], b))
    }

    #[inline(always)]
    fn keep(self, a: Self::Floats, bits: Self::Bits, least: u32) -> Self::Floats {
        each_part!(a, |p| self.0.keep(a[p], bits[p], least))
    }
}
