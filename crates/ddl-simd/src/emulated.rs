//! Exact emulation of the bf16 instructions, for machines without them; slower than `f32`.

#![expect(clippy::inline_always, reason = "the lanes must stay in registers")]

use crate::lanes::LANES;
use crate::pairs::{Floats, PairKernel, Pairs};
use crate::register::{Register, RegisterKernel};
use crate::simd::Simd;

/// Plain loops over pairs, with the `f32` arithmetic of an instruction set.
#[derive(Clone, Copy, Debug)]
struct Emulated<S>(S);

pub(crate) struct OnEmulated<K>(pub(crate) K);

impl<K: PairKernel> RegisterKernel for OnEmulated<K> {
    type Output = ();

    #[inline(always)]
    fn run<R: Register>(self, register: R) {
        self.0.run(Emulated(register.sixteen()));
    }
}

type Words = [u32; LANES];

impl<S: Simd> Emulated<S> {
    #[inline(always)]
    fn numbers(self, floats: S::Floats) -> [f32; LANES] {
        let mut numbers = [0.0; LANES];
        self.0.store(floats, &mut numbers);
        numbers
    }
}

impl<S: Simd> Pairs for Emulated<S> {
    type Simd = S;
    type Words = Words;

    #[inline(always)]
    fn simd(self) -> S {
        self.0
    }

    #[inline(always)]
    fn splat(self, pair: u32) -> Words {
        [pair; LANES]
    }

    #[inline(always)]
    fn load(self, from: &Words) -> Words {
        *from
    }

    #[inline(always)]
    fn store(self, value: Words, into: &mut Words) {
        *into = value;
    }

    #[inline(always)]
    fn neighbours(self, a: Floats<Self>, b: Floats<Self>) -> Words {
        let (a, b) = (self.numbers(a), self.numbers(b));
        let mut words = [0; LANES];
        for (l, word) in words.iter_mut().enumerate() {
            let from = if l < LANES / 2 { &a } else { &b };
            let first = 2 * l % LANES;
            *word = rounded(from[first]) | rounded(from[first + 1]) << 16;
        }
        words
    }

    #[inline(always)]
    fn across(self, a: Floats<Self>, b: Floats<Self>) -> Words {
        let (a, b) = (self.numbers(a), self.numbers(b));
        let mut words = [0; LANES];
        for l in 0..LANES {
            words[l] = rounded(a[l]) | rounded(b[l]) << 16;
        }
        words
    }

    #[inline(always)]
    fn dot(self, a: Words, b: Words, sum: Floats<Self>) -> Floats<Self> {
        let upper = |word: u32| normal(f32::from_bits(word & 0xffff_0000));
        let lower = |word: u32| normal(f32::from_bits(word << 16));
        let mut sums = self.numbers(sum);
        for l in 0..LANES {
            // Each operation is rounded once, on every machine.
            let first = normal(upper(a[l]).mul_add(upper(b[l]), normal(sums[l])));
            sums[l] = normal(lower(a[l]).mul_add(lower(b[l]), first));
        }
        self.0.load(&sums)
    }
}

/// The upper half of the nearest bf16 number, ties to even. NaN stays NaN.
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
