//! Arithmetic on pairs of bf16 numbers.

use crate::lanes::LANES;
use crate::simd::Simd;

/// Arithmetic on sixteen pairs of bf16 numbers at a time, in addition to that on `f32`.
///
/// A bf16 number is the upper half of an `f32`: the same range, with 8 significant bits. A pair is a 32-bit word; the
/// first number is its lower half.
///
/// # Numerics
/// The results are those of the AVX-512 BF16 instructions: rounded to nearest, ties to even; subnormal arguments and
/// results count as 0.
pub trait Pairs: Copy + Send + Sync {
    /// The arithmetic on `f32`.
    type Simd: Simd;
    /// Sixteen pairs.
    type Words: Copy;

    /// The arithmetic on `f32`.
    fn simd(self) -> Self::Simd;

    /// `pair` in every lane.
    fn splat(self, pair: u32) -> Self::Words;
    /// The pairs of an array.
    fn load(self, from: &[u32; LANES]) -> Self::Words;
    /// Writes the pairs to an array.
    fn store(self, value: Self::Words, into: &mut [u32; LANES]);
    /// Rounds to bf16 and pairs numbers 0 and 1 of `a`, 2 and 3, and so on; then those of `b`.
    fn neighbours(self, a: Floats<Self>, b: Floats<Self>) -> Self::Words;
    /// Rounds to bf16 and pairs number 0 of `a` with number 0 of `b`, and so on.
    fn across(self, a: Floats<Self>, b: Floats<Self>) -> Self::Words;
    /// (sum + a₁ b₁) + a₀ b₀ for each two pairs, rounded after each addition.
    fn dot(self, a: Self::Words, b: Self::Words, sum: Floats<Self>) -> Floats<Self>;
}

/// The type of sixteen `f32` that belongs to `P`.
pub type Floats<P> = <<P as Pairs>::Simd as Simd>::Floats;

/// A computation on pairs that is compiled once for each instruction set. The rules of [`Kernel`](crate::Kernel) apply.
pub trait PairKernel {
    /// The computation.
    fn run<P: Pairs>(self, pairs: P);
}
