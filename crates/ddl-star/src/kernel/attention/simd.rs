//! The arithmetic of the kernels, on whatever vector instructions the machine has.

#![expect(clippy::inline_always, reason = "the lanes must stay in registers")]

use super::lanes::{Block, DEPTH, LANES};

/// Arithmetic on sixteen numbers at a time, in one or more registers.
///
/// A value of a type that implements it is the proof that the machine has the instructions, so that all methods are safe
/// to call.
pub(crate) trait Simd: Copy + Send + Sync {
    /// Sixteen numbers.
    type Wide: Copy;

    /// Compiles `kernel` with this instruction set and runs it.
    fn run<K: Kernel>(self, kernel: K);

    fn splat(self, value: f32) -> Self::Wide;
    fn load(self, from: &[f32; LANES]) -> Self::Wide;
    fn store(self, value: Self::Wide, into: &mut [f32; LANES]);
    fn add(self, a: Self::Wide, b: Self::Wide) -> Self::Wide;
    fn sub(self, a: Self::Wide, b: Self::Wide) -> Self::Wide;
    fn mul(self, a: Self::Wide, b: Self::Wide) -> Self::Wide;
    fn div(self, a: Self::Wide, b: Self::Wide) -> Self::Wide;
    /// The larger of each two numbers; `b` where one is NaN.
    fn max(self, a: Self::Wide, b: Self::Wide) -> Self::Wide;
    /// a b + c, rounded once or twice.
    fn mul_add(self, a: Self::Wide, b: Self::Wide, c: Self::Wide) -> Self::Wide;
    /// Adds the low bits of `exponent`'s representation to the exponent of `power`.
    fn scale(self, power: Self::Wide, exponent: Self::Wide) -> Self::Wide;
    /// Lane 4 i + j of group k becomes lane 4 i + k of group j: its own inverse.
    fn transpose(self, groups: Vectors<Self>) -> Vectors<Self>;
    /// Lane 4 i + j of the result is lane 4 i + `FROM` / 0x55 of `a`, the way instructions encode it.
    fn spread<const FROM: i32>(self, a: Self::Wide) -> Self::Wide;

    #[inline(always)]
    fn read(self, block: &Block) -> Vectors<Self> {
        let [a, b, c, d] = block;
        [
            self.load(&a.0),
            self.load(&b.0),
            self.load(&c.0),
            self.load(&d.0),
        ]
    }

    #[inline(always)]
    fn write(self, vectors: Vectors<Self>, block: &mut Block) {
        for d in 0..DEPTH {
            self.store(vectors[d], &mut block[d].0);
        }
    }

    /// Σ a b over four vectors, added to `start`.
    #[inline(always)]
    fn dot(self, a: Vectors<Self>, b: Vectors<Self>, start: Self::Wide) -> Self::Wide {
        let mut sum = start;
        for d in 0..DEPTH {
            sum = self.mul_add(a[d], b[d], sum);
        }
        sum
    }

    /// `sum` + `weight` · `vectors`.
    #[inline(always)]
    fn accumulate(
        self,
        sum: Vectors<Self>,
        weight: Self::Wide,
        vectors: Vectors<Self>,
    ) -> Vectors<Self> {
        let mut sum = sum;
        for d in 0..DEPTH {
            sum[d] = self.mul_add(weight, vectors[d], sum[d]);
        }
        sum
    }

    /// `factor` · `vectors`.
    #[inline(always)]
    fn scaled(self, vectors: Vectors<Self>, factor: Self::Wide) -> Vectors<Self> {
        let mut result = vectors;
        for d in 0..DEPTH {
            result[d] = self.mul(vectors[d], factor);
        }
        result
    }
}

/// Four times sixteen numbers.
pub(crate) type Vectors<S> = [<S as Simd>::Wide; DEPTH];

/// A computation that is compiled once for each instruction set.
///
/// `run` must be `#[inline(always)]`, and so must everything it calls with vectors: code that is not inlined, closures
/// included, is not compiled for the instruction set.
pub(crate) trait Kernel {
    fn run<S: Simd>(self, simd: S);
}
