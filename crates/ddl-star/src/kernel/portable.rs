//! Plain loops over arrays, which the compiler turns into the vector instructions every machine of its kind has.

#![expect(clippy::inline_always, reason = "the lanes must stay in registers")]

use super::lanes::{DEPTH, LANES};
use super::simd::{Kernel, PairKernel, Pairs, Simd, TiledKernel};

/// No particular instructions.
#[derive(Clone, Copy, Debug)]
pub(super) struct Portable;

type Floats = [f32; LANES];
type Bits = [u32; LANES];

/// Applies an expression to each lane. A loop, not `map`: the call `map` makes is not always inlined.
macro_rules! each_lane {
    ($a:ident, |$l:ident| $value:expr) => {{
        let mut result = $a;
        for $l in 0..LANES {
            result[$l] = $value;
        }
        result
    }};
}

impl Simd for Portable {
    type Floats = Floats;
    type Bits = Bits;

    #[inline]
    fn run<K: Kernel>(self, kernel: K) {
        kernel.run(self);
    }

    #[inline(always)]
    fn run_tiled<K: TiledKernel>(self, kernel: K) {
        // Half of the sixteen registers that most machines have.
        kernel.run::<Self, 2, 1>(self);
    }

    #[inline(always)]
    fn splat(self, value: f32) -> Floats {
        [value; LANES]
    }

    #[inline(always)]
    fn load(self, from: &Floats) -> Floats {
        *from
    }

    #[inline(always)]
    fn store(self, value: Floats, into: &mut Floats) {
        *into = value;
    }

    #[inline(always)]
    fn add(self, a: Floats, b: Floats) -> Floats {
        each_lane!(a, |l| a[l] + b[l])
    }

    #[inline(always)]
    fn sub(self, a: Floats, b: Floats) -> Floats {
        each_lane!(a, |l| a[l] - b[l])
    }

    #[inline(always)]
    fn mul(self, a: Floats, b: Floats) -> Floats {
        each_lane!(a, |l| a[l] * b[l])
    }

    #[inline(always)]
    fn div(self, a: Floats, b: Floats) -> Floats {
        each_lane!(a, |l| a[l] / b[l])
    }

    #[inline(always)]
    fn sqrt(self, a: Floats) -> Floats {
        each_lane!(a, |l| a[l].sqrt())
    }

    #[inline(always)]
    fn max(self, a: Floats, b: Floats) -> Floats {
        each_lane!(a, |l| if a[l] > b[l] { a[l] } else { b[l] })
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
    fn zero_unless_positive(self, condition: Floats, a: Floats) -> Floats {
        each_lane!(a, |l| if condition[l] <= 0.0 { 0.0 } else { a[l] })
    }

    #[inline(always)]
    fn scale(self, power: Floats, exponent: Floats) -> Floats {
        each_lane!(power, |l| f32::from_bits(
            power[l].to_bits().wrapping_add(exponent[l].to_bits() << 23)
        ))
    }

    #[inline(always)]
    fn transpose(self, groups: [Floats; DEPTH]) -> [Floats; DEPTH] {
        let mut result = groups;
        for k in 0..DEPTH {
            for j in 0..DEPTH {
                for i in 0..LANES / DEPTH {
                    result[j][4 * i + k] = groups[k][4 * i + j];
                }
            }
        }
        result
    }

    #[inline(always)]
    fn spread<const FROM: i32>(self, a: Floats) -> Floats {
        let from = (FROM / 0x55) as usize;
        each_lane!(a, |l| a[l / 4 * 4 + from])
    }

    #[inline(always)]
    fn sum_of_quarters(self, a: Floats) -> Floats {
        each_lane!(a, |l| {
            let j = l % DEPTH;
            (a[j] + a[j + 8]) + (a[j + 4] + a[j + 12])
        })
    }

    #[inline(always)]
    fn count_from(self, first: u32) -> Bits {
        let mut value = [0; LANES];
        for (l, lane) in value.iter_mut().enumerate() {
            *lane = first ^ l as u32;
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

/// The bf16 instructions, emulated to the bit: for machines without them, slower than `f32`.
impl Pairs for Portable {
    type Simd = Self;
    type Words = Bits;

    #[inline(always)]
    fn simd(self) -> Self {
        self
    }

    #[inline(always)]
    fn run_pairs<K: PairKernel>(self, kernel: K) {
        kernel.run(self);
    }

    #[inline(always)]
    fn splat(self, pair: u32) -> Bits {
        [pair; LANES]
    }

    #[inline(always)]
    fn load(self, from: &Bits) -> Bits {
        *from
    }

    #[inline(always)]
    fn store(self, value: Bits, into: &mut Bits) {
        *into = value;
    }

    #[inline(always)]
    fn neighbours(self, a: Floats, b: Floats) -> Bits {
        let mut words = [0; LANES];
        for (l, word) in words.iter_mut().enumerate() {
            let from = if l < LANES / 2 { &a } else { &b };
            let first = 2 * l % LANES;
            *word = rounded(from[first]) | rounded(from[first + 1]) << 16;
        }
        words
    }

    #[inline(always)]
    fn across(self, a: Floats, b: Floats) -> Bits {
        let mut words = [0; LANES];
        for l in 0..LANES {
            words[l] = rounded(a[l]) | rounded(b[l]) << 16;
        }
        words
    }

    #[inline(always)]
    fn dot(self, a: Bits, b: Bits, sum: Floats) -> Floats {
        each_lane!(sum, |l| {
            let upper = |word: u32| normal(f32::from_bits(word & 0xffff_0000));
            let lower = |word: u32| normal(f32::from_bits(word << 16));
            // Rounded once each, whatever the machine.
            let sum = normal(upper(a[l]).mul_add(upper(b[l]), normal(sum[l])));
            normal(lower(a[l]).mul_add(lower(b[l]), sum))
        })
    }
}

/// The upper half of the nearest bf16 number, ties to even. What is not a number stays so.
#[inline(always)]
fn rounded(value: f32) -> u32 {
    let bits = normal(value).to_bits();
    if value.is_nan() {
        return bits >> 16 | 0x40;
    }
    (bits + 0x7fff + (bits >> 16 & 1)) >> 16
}

/// 0 of the same sign for a subnormal number.
#[inline(always)]
fn normal(value: f32) -> f32 {
    if value.abs() < f32::MIN_POSITIVE {
        0.0_f32.copysign(value)
    } else {
        value
    }
}
