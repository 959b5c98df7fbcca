//! Arithmetic on sixteen numbers, and traits of the computations that use it.

#![expect(clippy::inline_always, reason = "the lanes must stay in registers")]

use crate::lanes::{DEPTH, HALF, HalfQuad, LANES, Quad};

/// Arithmetic on sixteen numbers at a time, in one or more registers.
///
/// A value that implements this trait proves that the machine has the instructions, so all methods are safe to call.
///
/// # Numerics
/// Every operation is rounded once to the nearest `f32`, except [`mul_add`](Self::mul_add), which portable code may
/// round twice.
pub trait Simd: Copy + Send + Sync {
    /// Sixteen numbers.
    type Floats: Copy;
    /// Sixteen words of 32 bits.
    type Bits: Copy;

    /// Runs `kernel` from within another kernel, with the [`Tile`] size that fits the registers.
    fn run_tiled<K: TiledKernel>(self, kernel: K);

    /// `value` in every lane.
    fn splat(self, value: f32) -> Self::Floats;
    /// The numbers of an array.
    fn load(self, from: &[f32; LANES]) -> Self::Floats;
    /// Writes the numbers to an array.
    fn store(self, value: Self::Floats, into: &mut [f32; LANES]);
    /// The numbers of two arrays in the lower and in the upper lanes.
    fn load_halves(self, low: &[f32; HALF], high: &[f32; HALF]) -> Self::Floats;
    /// Writes the lower and the upper lanes to two arrays.
    fn store_halves(self, value: Self::Floats, low: &mut [f32; HALF], high: &mut [f32; HALF]);
    /// Asks the processor to load the cache line of this number soon. Does nothing where no instruction does that.
    fn prefetch(self, number: &f32);
    /// a + b.
    fn add(self, a: Self::Floats, b: Self::Floats) -> Self::Floats;
    /// a − b.
    fn sub(self, a: Self::Floats, b: Self::Floats) -> Self::Floats;
    /// a b.
    fn mul(self, a: Self::Floats, b: Self::Floats) -> Self::Floats;
    /// a / b.
    fn div(self, a: Self::Floats, b: Self::Floats) -> Self::Floats;
    /// √a.
    fn sqrt(self, a: Self::Floats) -> Self::Floats;
    /// The larger of each two numbers; `b` if one of them is NaN.
    fn max(self, a: Self::Floats, b: Self::Floats) -> Self::Floats;
    /// The smaller of each two numbers; `b` if one of them is NaN.
    fn min(self, a: Self::Floats, b: Self::Floats) -> Self::Floats;
    /// Bit l is set where a >= b in lane l.
    fn at_least(self, a: Self::Floats, b: Self::Floats) -> u32;
    /// `taken` where a >= b, `other` elsewhere.
    fn where_at_least(self, a: Self::Floats, b: Self::Floats, taken: Self::Floats, other: Self::Floats)
    -> Self::Floats;
    /// a b + c, rounded once or twice.
    fn mul_add(self, a: Self::Floats, b: Self::Floats, c: Self::Floats) -> Self::Floats;
    /// 0 where `condition` <= 0, `a` elsewhere (also where `condition` is NaN).
    fn zero_unless_positive(self, condition: Self::Floats, a: Self::Floats) -> Self::Floats;
    /// 2^`exponent` for exponents that are not positive; exactly 0 below −96 and for NaN.
    ///
    /// # Numerics
    /// The relative error is below 3e-7 down to −96, and the result is exactly 1 at 0.
    fn exp2(self, exponent: Self::Floats) -> Self::Floats;
    /// Lane 4 i + j of group k becomes lane 4 i + k of group j. The operation is its own inverse.
    fn transpose(self, groups: Vectors<Self>) -> Vectors<Self>;
    /// Lane 4 i + j of the result is lane 4 i + `FROM` / 0x55 of `a`; `FROM` is encoded as in the instructions.
    fn spread<const FROM: i32>(self, a: Self::Floats) -> Self::Floats;
    /// Lane 4 i + j of the result is the sum of the lanes 4 k + j of `a` over k, (0 + 2) + (1 + 3).
    fn sum_of_quarters(self, a: Self::Floats) -> Self::Floats;

    /// Lane l is `first` xor l.
    fn count_from(self, first: u32) -> Self::Bits;
    /// a xor b.
    fn xor(self, a: Self::Bits, b: u32) -> Self::Bits;
    /// a xor (a >> `N`).
    fn xor_shift<const N: u32>(self, a: Self::Bits) -> Self::Bits;
    /// a << `N`.
    fn shift_left<const N: u32>(self, a: Self::Bits) -> Self::Bits;
    /// The low 32 bits of the product.
    fn mul_low(self, a: Self::Bits, b: u32) -> Self::Bits;
    /// `a` where `bits` >= `least`, 0 elsewhere.
    fn keep(self, a: Self::Floats, bits: Self::Bits, least: u32) -> Self::Floats;

    /// Lane 4 i + j of vector k is lane 4 i + k of `a`.
    #[inline(always)]
    fn spread_each(self, a: Self::Floats) -> Vectors<Self> {
        [
            self.spread::<0x00>(a),
            self.spread::<0x55>(a),
            self.spread::<0xaa>(a),
            self.spread::<0xff>(a),
        ]
    }

    /// The vectors of a quad.
    #[inline(always)]
    fn read(self, quad: &Quad) -> Vectors<Self> {
        let [a, b, c, d] = quad;
        [self.load(&a.0), self.load(&b.0), self.load(&c.0), self.load(&d.0)]
    }

    /// Writes the vectors to a quad.
    #[inline(always)]
    fn write(self, vectors: Vectors<Self>, quad: &mut Quad) {
        for d in 0..DEPTH {
            self.store(vectors[d], &mut quad[d].0);
        }
    }

    /// The vectors of a half, in the lower and again in the upper lanes.
    #[inline(always)]
    fn read_twice(self, half: &HalfQuad) -> Vectors<Self> {
        let [a, b, c, d] = &half.0;
        [
            self.load_halves(a, a),
            self.load_halves(b, b),
            self.load_halves(c, c),
            self.load_halves(d, d),
        ]
    }

    /// Writes the lower and the upper lanes of four vectors.
    #[inline(always)]
    fn write_halves(self, vectors: Vectors<Self>, low: &mut HalfQuad, high: &mut HalfQuad) {
        for (d, vector) in vectors.into_iter().enumerate() {
            self.store_halves(vector, &mut low.0[d], &mut high.0[d]);
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
    fn accumulate(self, sum: Vectors<Self>, weight: Self::Floats, vectors: Vectors<Self>) -> Vectors<Self> {
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
pub type Vectors<S> = [<S as Simd>::Floats; DEPTH];

/// Accumulators of a product of matrices: `R` rows of `V` times sixteen numbers.
pub type Tile<S, const R: usize, const V: usize> = [[<S as Simd>::Floats; V]; R];

/// A computation that is compiled once for each instruction set.
///
/// `run` must be `#[inline(always)]`, and so must everything it calls with vectors. Code that is not inlined, including
/// closures, is not compiled for the instruction set.
pub trait Kernel {
    /// The computation.
    fn run<S: Simd>(self, simd: S);
}

/// A [`Kernel`] for matrix products, written for a [`Tile`] of any size.
///
/// The instruction set determines how many accumulators fit its registers: `R` divides 8, `V` is 1 or 2. The rules of
/// [`Kernel`] apply.
pub trait TiledKernel {
    /// The computation.
    fn run<S: Simd, const R: usize, const V: usize>(self, simd: S);
}

impl<K: TiledKernel> Kernel for K {
    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        simd.run_tiled(self);
    }
}
