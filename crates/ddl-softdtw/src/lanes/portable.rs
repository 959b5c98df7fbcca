//! Plain loops over short arrays, which the compiler turns into the vector instructions every machine of its kind has.

#![expect(clippy::inline_always, reason = "the lanes must stay in registers")]

use super::{FLOOR, Kernel, Lanes, Simd, WideLanes};

/// Lanes of a part: what the smallest vector registers hold.
const WIDTH: usize = 4;
type Narrow = [f32; WIDTH];
type Wide = [f64; WIDTH / 2];

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
    type Narrow = Narrow;
    type Wide = Wide;
    const WIDTH: usize = WIDTH;
    const FLOOR: f32 = FLOOR;

    #[inline]
    fn run<K: Kernel>(self, kernel: K) -> K::Output {
        kernel.run(self)
    }

    #[inline(always)]
    fn splat(self, value: f32) -> Narrow {
        [value; WIDTH]
    }

    #[inline(always)]
    fn load(self, from: &Lanes, part: usize) -> Narrow {
        let mut value = [0.0; WIDTH];
        value.copy_from_slice(&from[part * WIDTH..][..WIDTH]);
        value
    }

    #[inline(always)]
    fn store(self, value: Narrow, into: &mut Lanes, part: usize) {
        into[part * WIDTH..][..WIDTH].copy_from_slice(&value);
    }

    #[inline(always)]
    fn add(self, a: Narrow, b: Narrow) -> Narrow {
        each_lane!(a, |l| a[l] + b[l])
    }

    #[inline(always)]
    fn sub(self, a: Narrow, b: Narrow) -> Narrow {
        each_lane!(a, |l| a[l] - b[l])
    }

    #[inline(always)]
    fn mul(self, a: Narrow, b: Narrow) -> Narrow {
        each_lane!(a, |l| a[l] * b[l])
    }

    #[inline(always)]
    fn div(self, a: Narrow, b: Narrow) -> Narrow {
        each_lane!(a, |l| a[l] / b[l])
    }

    #[inline(always)]
    fn mul_add(self, a: Narrow, b: Narrow, c: Narrow) -> Narrow {
        each_lane!(a, |l| a[l] * b[l] + c[l])
    }

    #[inline(always)]
    fn neg_mul_add(self, a: Narrow, b: Narrow, c: Narrow) -> Narrow {
        each_lane!(a, |l| c[l] - a[l] * b[l])
    }

    #[inline(always)]
    fn max(self, a: Narrow, b: Narrow) -> Narrow {
        each_lane!(a, |l| if a[l] > b[l] { a[l] } else { b[l] })
    }

    #[inline(always)]
    fn at_least(self, a: Narrow, b: Narrow) -> u32 {
        let mut mask = 0;
        for l in 0..WIDTH {
            mask |= u32::from(a[l] >= b[l]) << l;
        }
        mask
    }

    #[inline(always)]
    fn scale(self, power: Narrow, exponent: Narrow) -> Narrow {
        each_lane!(power, |l| {
            let bits = power[l].to_bits();
            f32::from_bits(bits.wrapping_add(exponent[l].to_bits() << 23))
        })
    }

    #[inline(always)]
    fn weigh(self, k: Narrow, b: Narrow) -> Narrow {
        each_lane!(k, |l| k[l] * (b[l] + FLOOR))
    }

    #[inline(always)]
    fn cell(self, k: Narrow, diagonal: Narrow, up: Narrow, left: Narrow) -> Narrow {
        each_lane!(k, |l| k[l] * ((diagonal[l] + up[l] + FLOOR) + left[l]))
    }

    #[inline(always)]
    fn wide_splat(self, value: f64) -> Wide {
        [value; WIDTH / 2]
    }

    #[inline(always)]
    fn wide_load(self, from: &WideLanes, part: usize) -> Wide {
        let mut value = [0.0; WIDTH / 2];
        value.copy_from_slice(&from[part * WIDTH / 2..][..WIDTH / 2]);
        value
    }

    #[inline(always)]
    fn wide_store(self, value: Wide, into: &mut WideLanes, part: usize) {
        into[part * WIDTH / 2..][..WIDTH / 2].copy_from_slice(&value);
    }

    #[inline(always)]
    fn wide_add(self, a: Wide, b: Wide) -> Wide {
        each_lane!(a, |l| a[l] + b[l])
    }

    #[inline(always)]
    fn wide_sub(self, a: Wide, b: Wide) -> Wide {
        each_lane!(a, |l| a[l] - b[l])
    }

    #[inline(always)]
    fn wide_mul(self, a: Wide, b: Wide) -> Wide {
        each_lane!(a, |l| a[l] * b[l])
    }

    #[inline(always)]
    fn wide_max(self, a: Wide, b: Wide) -> Wide {
        each_lane!(a, |l| if a[l] > b[l] { a[l] } else { b[l] })
    }

    #[inline(always)]
    fn wide_sqrt(self, a: Wide) -> Wide {
        each_lane!(a, |l| a[l].sqrt())
    }

    #[inline(always)]
    fn wide_scale(self, power: Wide, exponent: Wide) -> Wide {
        each_lane!(power, |l| {
            let bits = power[l].to_bits();
            f64::from_bits(bits.wrapping_add(exponent[l].to_bits() << 52))
        })
    }
}
