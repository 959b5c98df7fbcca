//! Plain loops over short arrays, which the compiler turns into the vector instructions every machine of its kind has.

#![expect(clippy::inline_always, reason = "the lanes must stay in registers")]

use super::Block;
use super::simd::{Kernel, Simd};

/// Lanes: what the smallest vector registers hold.
const WIDTH: usize = 4;
type Floats = [f32; WIDTH];
type Bits = [u32; WIDTH];

/// No particular instructions.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Portable;

/// Applies an expression to each lane. A loop, not `map`: the call `map` makes is not always inlined.
macro_rules! each_lane {
    ($a:ident, |$l:ident| $value:expr) => {{
        let mut result = $a;
        for $l in 0..result.len() {
            result[$l] = $value;
        }
        result
    }};
}

impl Simd for Portable {
    type Floats = Floats;
    type Bits = Bits;
    const WIDTH: usize = WIDTH;

    #[inline]
    fn run<K: Kernel>(self, kernel: K) -> K::Output {
        kernel.run::<Self, 4, 2>(self)
    }

    #[inline(always)]
    fn splat(self, value: f32) -> Floats {
        [value; WIDTH]
    }

    #[inline(always)]
    fn load(self, from: &Block, part: usize) -> Floats {
        let mut value = [0.0; WIDTH];
        value.copy_from_slice(&from.0[part * WIDTH..][..WIDTH]);
        value
    }

    #[inline(always)]
    fn store(self, value: Floats, into: &mut Block, part: usize) {
        into.0[part * WIDTH..][..WIDTH].copy_from_slice(&value);
    }

    #[inline(always)]
    fn add(self, a: Floats, b: Floats) -> Floats {
        each_lane!(a, |l| a[l] + b[l])
    }

    #[inline(always)]
    fn mul(self, a: Floats, b: Floats) -> Floats {
        each_lane!(a, |l| a[l] * b[l])
    }

    #[inline(always)]
    fn mul_add(self, a: Floats, b: Floats, c: Floats) -> Floats {
        // Without the instruction a fused product is a slow call of the mathematical library.
        if cfg!(any(target_feature = "fma", target_arch = "aarch64")) {
            each_lane!(a, |l| a[l].mul_add(b[l], c[l]))
        } else {
            each_lane!(a, |l| a[l] * b[l] + c[l])
        }
    }

    #[inline(always)]
    fn relu(self, a: Floats) -> Floats {
        each_lane!(a, |l| if a[l] < 0.0 { 0.0 } else { a[l] })
    }

    #[inline(always)]
    fn zero_unless_positive(self, condition: Floats, a: Floats) -> Floats {
        each_lane!(a, |l| if condition[l] <= 0.0 { 0.0 } else { a[l] })
    }

    #[inline(always)]
    fn count_from(self, first: u32, part: usize) -> Bits {
        let mut value = [0; WIDTH];
        for (l, lane) in value.iter_mut().enumerate() {
            *lane = first ^ (part * WIDTH + l) as u32;
        }
        value
    }

    #[inline(always)]
    fn xor(self, a: Bits, b: u32) -> Bits {
        each_lane!(a, |l| a[l] ^ b)
    }

    #[inline(always)]
    fn xor_shift<const N: u32>(self, a: Bits) -> Bits {
        each_lane!(a, |l| a[l] ^ (a[l] >> N))
    }

    #[inline(always)]
    fn shift_left<const N: u32>(self, a: Bits) -> Bits {
        each_lane!(a, |l| a[l] << N)
    }

    #[inline(always)]
    fn mul_low(self, a: Bits, b: u32) -> Bits {
        each_lane!(a, |l| a[l].wrapping_mul(b))
    }

    #[inline(always)]
    fn keep(self, a: Floats, bits: Bits, least: u32) -> Floats {
        each_lane!(a, |l| if bits[l] >= least { a[l] } else { 0.0 })
    }
}
