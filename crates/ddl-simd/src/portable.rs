//! Plain loops over short arrays, which the compiler vectorises with the baseline instructions of the target.

#![expect(clippy::inline_always, reason = "the lanes must stay in registers")]

use crate::exp2::{WIDE_ROUNDING, normal};
use crate::lanes::{HALF, LANES, WIDE_LANES};
use crate::register::{Register, RegisterKernel};
use crate::simd::TiledKernel;
use crate::sixteen::Sixteen;

/// Lanes of a part: the size of the smallest vector registers.
const WIDTH: usize = 4;
type Floats = [f32; WIDTH];
type Bits = [u32; WIDTH];
type Wide = [f64; WIDTH / 2];

#[derive(Clone, Copy, Debug)]
pub(crate) struct Portable;

/// Applies an expression to each lane. A loop, because the call that `map` makes is not always inlined.
macro_rules! each_lane {
    ($a:ident, |$l:ident| $value:expr) => {{
        let mut result = $a;
        for $l in 0..result.len() {
            result[$l] = $value;
        }
        result
    }};
}

macro_rules! lane_by_lane {
    ($(fn $name:ident$(<const $n:ident: $constant:ty>)?($($a:ident: $kind:ty),*; $($b:ident: $scalar:ty),*)
        -> $result:ident = |$l:ident| $value:expr;)*) => {$(
        #[inline(always)]
        fn $name$(<const $n: $constant>)?(self, $($a: $kind,)* $($b: $scalar),*) -> $result {
            let mut result = <$result>::default();
            for $l in 0..result.len() {
                result[$l] = $value;
            }
            result
        }
    )*};
}

impl Register for Portable {
    type Floats = Floats;
    type Bits = Bits;
    type Wide = Wide;
    type Sixteen = Sixteen<Self, 4>;
    const WIDTH: usize = WIDTH;
    // On machines without the instruction, a fused product would be a slow call of the math library.
    const FUSED: bool = cfg!(any(target_feature = "fma", target_arch = "aarch64"));

    #[inline]
    fn run<K: RegisterKernel>(self, kernel: K) -> K::Output {
        kernel.run(self)
    }

    #[inline(always)]
    fn sixteen(self) -> Self::Sixteen {
        Sixteen(self)
    }

    #[inline(always)]
    fn run_tiled<K: TiledKernel>(self, kernel: K) {
        // The accumulators fill half of the sixteen registers of most machines.
        kernel.run::<Self::Sixteen, 2, 1>(Sixteen(self));
    }

    #[inline(always)]
    fn load(self, from: &[f32; LANES], part: usize) -> Floats {
        from.as_chunks().0[part]
    }

    #[inline(always)]
    fn store(self, value: Floats, into: &mut [f32; LANES], part: usize) {
        into.as_chunks_mut().0[part] = value;
    }

    #[inline(always)]
    fn load_halves(self, from: [&[f32; HALF]; 2], part: usize) -> Floats {
        from[part / 2].as_chunks().0[part % 2]
    }

    #[inline(always)]
    fn store_halves(self, value: Floats, into: [&mut [f32; HALF]; 2], part: usize) {
        into[part / 2].as_chunks_mut().0[part % 2] = value;
    }

    #[inline(always)]
    fn mul_add(self, a: Floats, b: Floats, c: Floats) -> Floats {
        if Self::FUSED {
            each_lane!(a, |l| a[l].mul_add(b[l], c[l]))
        } else {
            each_lane!(a, |l| a[l] * b[l] + c[l])
        }
    }

    #[inline(always)]
    fn neg_mul_add(self, a: Floats, b: Floats, c: Floats) -> Floats {
        if Self::FUSED {
            each_lane!(a, |l| (-a[l]).mul_add(b[l], c[l]))
        } else {
            each_lane!(a, |l| c[l] - a[l] * b[l])
        }
    }

    #[inline(always)]
    fn at_least(self, a: Floats, b: Floats) -> u32 {
        let mut mask = 0;
        for l in 0..WIDTH {
            mask |= u32::from(a[l] >= b[l]) << l;
        }
        mask
    }

    #[inline(always)]
    fn exp2_each<const G: usize>(self, exponents: [Floats; G]) -> [Floats; G] {
        normal(self, exponents)
    }

    #[inline(always)]
    fn transpose(self, groups: [Floats; 4]) -> [Floats; 4] {
        let mut result = groups;
        for k in 0..WIDTH {
            for j in 0..WIDTH {
                result[j][k] = groups[k][j];
            }
        }
        result
    }

    #[inline(always)]
    fn sum_of_fours(self, a: Floats) -> Floats {
        a
    }

    #[inline(always)]
    fn wide_split(self, a: Wide) -> (Wide, Wide) {
        let integer = each_lane!(a, |l| (a[l] + WIDE_ROUNDING) - WIDE_ROUNDING);
        (integer, each_lane!(a, |l| a[l] - integer[l]))
    }

    #[inline(always)]
    fn wide_load(self, from: &[f64; WIDE_LANES], part: usize) -> Wide {
        from.as_chunks().0[part]
    }

    #[inline(always)]
    fn wide_store(self, value: Wide, into: &mut [f64; WIDE_LANES], part: usize) {
        into.as_chunks_mut().0[part] = value;
    }

    lane_by_lane! {
        fn splat(; value: f32) -> Floats = |_l| value;
        fn add(a: Floats, b: Floats;) -> Floats = |l| a[l] + b[l];
        fn sub(a: Floats, b: Floats;) -> Floats = |l| a[l] - b[l];
        fn mul(a: Floats, b: Floats;) -> Floats = |l| a[l] * b[l];
        fn div(a: Floats, b: Floats;) -> Floats = |l| a[l] / b[l];
        fn sqrt(a: Floats;) -> Floats = |l| a[l].sqrt();
        fn max(a: Floats, b: Floats;) -> Floats = |l| if a[l] > b[l] { a[l] } else { b[l] };
        fn min(a: Floats, b: Floats;) -> Floats = |l| if a[l] < b[l] { a[l] } else { b[l] };
        fn where_at_least(a: Floats, b: Floats, taken: Floats, other: Floats;) -> Floats =
            |l| if a[l] >= b[l] { taken[l] } else { other[l] };
        fn zero_unless_positive(condition: Floats, a: Floats;) -> Floats =
            |l| if condition[l] <= 0.0 { 0.0 } else { a[l] };
        fn scale(power: Floats, exponent: Floats;) -> Floats =
            |l| f32::from_bits(power[l].to_bits().wrapping_add(exponent[l].to_bits() << 23));
        fn spread<const FROM: i32>(a: Floats;) -> Floats = |_l| a[(FROM / 0x55) as usize];

        fn count_from(; first: u32) -> Bits = |l| first ^ l as u32;
        fn xor(a: Bits; b: u32) -> Bits = |l| a[l] ^ b;
        fn xor_shift<const N: u32>(a: Bits;) -> Bits = |l| a[l] ^ (a[l] >> N);
        fn shift_left<const N: u32>(a: Bits;) -> Bits = |l| a[l] << N;
        fn mul_low(a: Bits; b: u32) -> Bits = |l| a[l].wrapping_mul(b);
        fn keep(a: Floats, bits: Bits; least: u32) -> Floats = |l| if bits[l] >= least { a[l] } else { 0.0 };

        fn wide_splat(; value: f64) -> Wide = |_l| value;
        fn wide_add(a: Wide, b: Wide;) -> Wide = |l| a[l] + b[l];
        fn wide_sub(a: Wide, b: Wide;) -> Wide = |l| a[l] - b[l];
        fn wide_mul(a: Wide, b: Wide;) -> Wide = |l| a[l] * b[l];
        fn wide_mul_add(a: Wide, b: Wide, c: Wide;) -> Wide = |l| a[l].mul_add(b[l], c[l]);
        fn wide_max(a: Wide, b: Wide;) -> Wide = |l| if a[l] > b[l] { a[l] } else { b[l] };
        fn wide_min(a: Wide, b: Wide;) -> Wide = |l| if a[l] < b[l] { a[l] } else { b[l] };
        fn wide_sqrt(a: Wide;) -> Wide = |l| a[l].sqrt();
        fn wide_opposite(a: Wide; bits: u64) -> Wide = |l| f64::from_bits(bits.wrapping_sub(a[l].to_bits()));
        fn wide_zero_unless_above(a: Wide, limit: Wide;) -> Wide = |l| if a[l] > limit[l] { a[l] } else { 0.0 };
        // The integer is in the low bits of the sum; added to the bits of the exponent it multiplies by 2^integer.
        fn wide_scale_far(number: Wide, exponent: Wide;) -> Wide =
            |l| f64::from_bits(number[l].to_bits().wrapping_add((exponent[l] + WIDE_ROUNDING).to_bits() << 52));
    }
}
