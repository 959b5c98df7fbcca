//! The arithmetic of the kernels, on whatever vector instructions the machine has.

#![expect(clippy::inline_always, reason = "the lanes must stay in registers")]

use super::lanes::{DEPTH, LANES, Quad};

/// Arithmetic on sixteen numbers at a time, in one or more registers.
///
/// A value of a type that implements it is the proof that the machine has the instructions, so that all methods are safe
/// to call.
pub(super) trait Simd: Copy + Send + Sync {
    /// Sixteen numbers.
    type Floats: Copy;
    /// Sixteen words of 32 bits.
    type Bits: Copy;

    /// Compiles `kernel` with this instruction set and runs it.
    fn run<K: Kernel>(self, kernel: K);
    /// Runs `kernel`, within one that runs already, with the [`Tile`] that the registers hold.
    fn run_tiled<K: TiledKernel>(self, kernel: K);

    fn splat(self, value: f32) -> Self::Floats;
    fn load(self, from: &[f32; LANES]) -> Self::Floats;
    fn store(self, value: Self::Floats, into: &mut [f32; LANES]);
    fn add(self, a: Self::Floats, b: Self::Floats) -> Self::Floats;
    fn sub(self, a: Self::Floats, b: Self::Floats) -> Self::Floats;
    fn mul(self, a: Self::Floats, b: Self::Floats) -> Self::Floats;
    fn div(self, a: Self::Floats, b: Self::Floats) -> Self::Floats;
    fn sqrt(self, a: Self::Floats) -> Self::Floats;
    /// The larger of each two numbers; `b` where one is NaN.
    fn max(self, a: Self::Floats, b: Self::Floats) -> Self::Floats;
    /// a b + c, rounded once or twice.
    fn mul_add(self, a: Self::Floats, b: Self::Floats, c: Self::Floats) -> Self::Floats;
    /// 0 where `condition` <= 0, `a` elsewhere (also where `condition` is NaN).
    fn zero_unless_positive(self, condition: Self::Floats, a: Self::Floats) -> Self::Floats;
    /// Adds the low bits of `exponent`'s representation to the exponent of `power`.
    fn scale(self, power: Self::Floats, exponent: Self::Floats) -> Self::Floats;
    /// Lane 4 i + j of group k becomes lane 4 i + k of group j: its own inverse.
    fn transpose(self, groups: Vectors<Self>) -> Vectors<Self>;
    /// Lane 4 i + j of the result is lane 4 i + `FROM` / 0x55 of `a`, the way instructions encode it.
    fn spread<const FROM: i32>(self, a: Self::Floats) -> Self::Floats;
    /// Lane 4 i + j of the result is the sum of the lanes 4 k + j of `a` over k.
    fn sum_of_quarters(self, a: Self::Floats) -> Self::Floats;

    /// Lane l is `first` xor l.
    fn count_from(self, first: u32) -> Self::Bits;
    fn xor(self, a: Self::Bits, b: u32) -> Self::Bits;
    /// a xor (a >> `N`).
    fn xor_shift<const N: u32>(self, a: Self::Bits) -> Self::Bits;
    fn shift_left<const N: u32>(self, a: Self::Bits) -> Self::Bits;
    /// The low 32 bits of the product.
    fn mul_low(self, a: Self::Bits, b: u32) -> Self::Bits;
    /// `a` where `bits` >= `least`, 0 elsewhere.
    fn keep(self, a: Self::Floats, bits: Self::Bits, least: u32) -> Self::Floats;

    #[inline(always)]
    fn read(self, quad: &Quad) -> Vectors<Self> {
        let [a, b, c, d] = quad;
        [
            self.load(&a.0),
            self.load(&b.0),
            self.load(&c.0),
            self.load(&d.0),
        ]
    }

    #[inline(always)]
    fn write(self, vectors: Vectors<Self>, quad: &mut Quad) {
        for d in 0..DEPTH {
            self.store(vectors[d], &mut quad[d].0);
        }
    }

    /// Σ a b over four vectors, added to `start`.
    #[inline(always)]
    fn dot(self, a: Vectors<Self>, b: Vectors<Self>, start: Self::Floats) -> Self::Floats {
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
        weight: Self::Floats,
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
    fn scaled(self, vectors: Vectors<Self>, factor: Self::Floats) -> Vectors<Self> {
        let mut result = vectors;
        for d in 0..DEPTH {
            result[d] = self.mul(vectors[d], factor);
        }
        result
    }
}

/// Four times sixteen numbers: a [`Quad`] in registers.
pub(super) type Vectors<S> = [<S as Simd>::Floats; DEPTH];

/// Accumulators of a product of matrices: `R` rows of `V` times sixteen numbers.
pub(super) type Tile<S, const R: usize, const V: usize> = [[<S as Simd>::Floats; V]; R];

/// A computation that is compiled once for each instruction set.
///
/// `run` must be `#[inline(always)]`, and so must everything it calls with vectors: code that is not inlined, closures
/// included, is not compiled for the instruction set.
pub(super) trait Kernel {
    fn run<S: Simd>(self, simd: S);
}

/// A [`Kernel`] of products of matrices, written for a [`Tile`] of any size.
///
/// The instruction set says how many accumulators its registers hold: `R` divides 8, `V` is 1 or 2. What is said of
/// [`Kernel::run`] holds here as well.
pub(super) trait TiledKernel {
    fn run<S: Simd, const R: usize, const V: usize>(self, simd: S);
}

impl<K: TiledKernel> Kernel for K {
    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        simd.run_tiled(self);
    }
}

/// Arithmetic on sixteen pairs of bf16 numbers at a time, beside that on `f32`.
///
/// A bf16 number is the upper half of an `f32`: its range, with 8 significant bits. A pair is a word of 32 bits, the first
/// number its lower half.
///
/// # Numerics
/// As the instructions of AVX-512 BF16 have it, to the bit: to the nearest, ties to even; what is subnormal counts as 0,
/// as argument and as result.
pub(super) trait Pairs: Copy + Send + Sync {
    /// The arithmetic on `f32`.
    type Simd: Simd;
    /// Sixteen pairs.
    type Words: Copy;

    fn simd(self) -> Self::Simd;
    /// Compiles `kernel` with this instruction set and runs it.
    fn run_pairs<K: PairKernel>(self, kernel: K);

    fn splat(self, pair: u32) -> Self::Words;
    fn load(self, from: &[u32; LANES]) -> Self::Words;
    fn store(self, value: Self::Words, into: &mut [u32; LANES]);
    /// Rounds to bf16 and pairs numbers 0 and 1 of `a`, 2 and 3, and so on; then those of `b`.
    fn neighbours(self, a: Floats<Self>, b: Floats<Self>) -> Self::Words;
    /// Rounds to bf16 and pairs number 0 of `a` with number 0 of `b`, and so on.
    fn across(self, a: Floats<Self>, b: Floats<Self>) -> Self::Words;
    /// (sum + a₁ b₁) + a₀ b₀ for each two pairs, rounded after each addition.
    fn dot(self, a: Self::Words, b: Self::Words, sum: Floats<Self>) -> Floats<Self>;
}

/// Sixteen `f32` beside sixteen pairs.
pub(super) type Floats<P> = <<P as Pairs>::Simd as Simd>::Floats;

/// A computation on pairs that is compiled once for each instruction set. What is said of [`Kernel`] holds.
pub(super) trait PairKernel {
    fn run<P: Pairs>(self, pairs: P);
}
