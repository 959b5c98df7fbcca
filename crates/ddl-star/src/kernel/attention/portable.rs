//! Plain loops over arrays, which the compiler turns into the vector instructions every machine of its kind has.

#![expect(clippy::inline_always, reason = "the lanes must stay in registers")]

use super::lanes::{DEPTH, LANES};
use super::simd::{Kernel, Simd};

/// No particular instructions.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Portable;

type Wide = [f32; LANES];

#[inline(always)]
fn zip(a: Wide, b: Wide, f: impl Fn(f32, f32) -> f32) -> Wide {
    let mut result = [0.0; LANES];
    for lane in 0..LANES {
        result[lane] = f(a[lane], b[lane]);
    }
    result
}

impl Simd for Portable {
    type Wide = Wide;

    #[inline]
    fn run<K: Kernel>(self, kernel: K) {
        kernel.run(self);
    }

    #[inline(always)]
    fn splat(self, value: f32) -> Wide {
        [value; LANES]
    }

    #[inline(always)]
    fn load(self, from: &Wide) -> Wide {
        *from
    }

    #[inline(always)]
    fn store(self, value: Wide, into: &mut Wide) {
        *into = value;
    }

    #[inline(always)]
    fn add(self, a: Wide, b: Wide) -> Wide {
        zip(a, b, |a, b| a + b)
    }

    #[inline(always)]
    fn sub(self, a: Wide, b: Wide) -> Wide {
        zip(a, b, |a, b| a - b)
    }

    #[inline(always)]
    fn mul(self, a: Wide, b: Wide) -> Wide {
        zip(a, b, |a, b| a * b)
    }

    #[inline(always)]
    fn div(self, a: Wide, b: Wide) -> Wide {
        zip(a, b, |a, b| a / b)
    }

    #[inline(always)]
    fn max(self, a: Wide, b: Wide) -> Wide {
        zip(a, b, |a, b| if a > b { a } else { b })
    }

    /// Rounded twice: without the instruction, `f32::mul_add` is a slow call.
    #[inline(always)]
    fn mul_add(self, a: Wide, b: Wide, c: Wide) -> Wide {
        self.add(self.mul(a, b), c)
    }

    #[inline(always)]
    fn scale(self, power: Wide, exponent: Wide) -> Wide {
        zip(power, exponent, |power, exponent| {
            f32::from_bits(power.to_bits().wrapping_add(exponent.to_bits() << 23))
        })
    }

    #[inline(always)]
    fn transpose(self, groups: [Wide; DEPTH]) -> [Wide; DEPTH] {
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
    fn spread<const FROM: i32>(self, a: Wide) -> Wide {
        let from = (FROM / 0x55) as usize;
        std::array::from_fn(|lane| a[lane / 4 * 4 + from])
    }
}
