//! Arithmetic on one register, as every instruction set must provide it.

#![expect(clippy::inline_always, reason = "the lanes must stay in registers")]

use crate::lanes::{HALF, LANES, WIDE_LANES};
use crate::simd::{Simd, TiledKernel};

/// Arithmetic on one register at a time, of `f32`, of `f64` and of 32-bit words.
///
/// Sixteen numbers of `f32` (eight of `f64`) are a group, which fills [`PARTS`](Self::PARTS) registers. A kernel that
/// needs many registers processes a group part by part; other kernels use [`Simd`], a whole group at a time.
/// Undocumented operations are those of [`Simd`], on one register; the prefix `wide_` marks `f64`. `part` is the index
/// of a register in its group.
///
/// A value that implements this trait proves that the machine has the instructions, so all methods are safe to call.
/// Loads and stores panic if `part >= PARTS`; the check is optimised away in a loop over `0..PARTS`.
///
/// # Numerics
/// Every instruction set gives the same bits in `f64`: only [`wide_mul_add`](Register::wide_mul_add) is fused, and it
/// is fused everywhere. Operations on `f32` may be fused.
#[expect(
    missing_docs,
    reason = "undocumented operations are those of `Simd`, on one register or on f64"
)]
pub trait Register: Copy + Send + Sync {
    /// `WIDTH` numbers of `f32`.
    type Floats: Copy;
    /// `WIDTH` words of 32 bits.
    type Bits: Copy;
    /// `WIDTH / 2` numbers of `f64`.
    type Wide: Copy;
    type Sixteen: Simd;
    const WIDTH: usize;
    /// Whether [`mul_add`](Self::mul_add) is rounded once.
    const FUSED: bool;
    /// Number of registers in a group.
    const PARTS: usize = LANES / Self::WIDTH;

    /// Compiles `kernel` with this instruction set and runs it.
    fn run<K: RegisterKernel>(self, kernel: K) -> K::Output;
    fn sixteen(self) -> Self::Sixteen;
    /// Runs `kernel` from within another kernel, with the [`Tile`](crate::Tile) size that fits the registers.
    fn run_tiled<K: TiledKernel>(self, kernel: K);

    fn splat(self, value: f32) -> Self::Floats;
    /// The `WIDTH` lanes of a group from `part * WIDTH` on.
    fn load(self, from: &[f32; LANES], part: usize) -> Self::Floats;
    fn store(self, value: Self::Floats, into: &mut [f32; LANES], part: usize);
    /// [`load`](Self::load) from a group whose halves are two arrays.
    fn load_halves(self, from: [&[f32; HALF]; 2], part: usize) -> Self::Floats;
    fn store_halves(self, value: Self::Floats, into: [&mut [f32; HALF]; 2], part: usize);
    #[inline(always)]
    fn prefetch(self, _number: &f32) {}
    fn add(self, a: Self::Floats, b: Self::Floats) -> Self::Floats;
    fn sub(self, a: Self::Floats, b: Self::Floats) -> Self::Floats;
    fn mul(self, a: Self::Floats, b: Self::Floats) -> Self::Floats;
    fn div(self, a: Self::Floats, b: Self::Floats) -> Self::Floats;
    fn sqrt(self, a: Self::Floats) -> Self::Floats;
    fn max(self, a: Self::Floats, b: Self::Floats) -> Self::Floats;
    fn min(self, a: Self::Floats, b: Self::Floats) -> Self::Floats;
    fn mul_add(self, a: Self::Floats, b: Self::Floats, c: Self::Floats) -> Self::Floats;
    /// c − a b, rounded once or twice.
    fn neg_mul_add(self, a: Self::Floats, b: Self::Floats, c: Self::Floats) -> Self::Floats;
    fn at_least(self, a: Self::Floats, b: Self::Floats) -> u32;
    fn where_at_least(self, a: Self::Floats, b: Self::Floats, taken: Self::Floats, other: Self::Floats)
    -> Self::Floats;
    fn zero_unless_positive(self, condition: Self::Floats, a: Self::Floats) -> Self::Floats;
    /// Adds the low bits of `exponent`'s representation to the exponent of `power`.
    fn scale(self, power: Self::Floats, exponent: Self::Floats) -> Self::Floats;
    /// 2^exponent of several registers, for exponents that are not positive. The registers are processed stage by
    /// stage, so that the processor can overlap them.
    ///
    /// # Numerics
    /// The relative error is below [`EXP2_ERROR`](crate::EXP2_ERROR). Exponents below
    /// −[`COST_LIMIT`](crate::COST_LIMIT) (and NaN) count as −[`COST_LIMIT`](crate::COST_LIMIT), so that no result is
    /// denormal.
    fn exp2_each<const G: usize>(self, exponents: [Self::Floats; G]) -> [Self::Floats; G];

    #[inline(always)]
    fn exp2(self, exponent: Self::Floats) -> Self::Floats {
        let [power] = self.exp2_each([exponent]);
        power
    }

    /// [`Simd::transpose`] of a part.
    fn transpose(self, groups: [Self::Floats; 4]) -> [Self::Floats; 4];
    /// [`Simd::spread`] of a part.
    fn spread<const FROM: i32>(self, a: Self::Floats) -> Self::Floats;
    /// Lane 4 i + j of the result is the sum of the lanes 4 k + j over k; the lanes farthest apart are added first.
    fn sum_of_fours(self, a: Self::Floats) -> Self::Floats;

    fn count_from(self, first: u32) -> Self::Bits;
    fn xor(self, a: Self::Bits, b: u32) -> Self::Bits;
    fn xor_shift<const N: u32>(self, a: Self::Bits) -> Self::Bits;
    fn shift_left<const N: u32>(self, a: Self::Bits) -> Self::Bits;
    fn mul_low(self, a: Self::Bits, b: u32) -> Self::Bits;
    fn keep(self, a: Self::Floats, bits: Self::Bits, least: u32) -> Self::Floats;

    fn wide_splat(self, value: f64) -> Self::Wide;
    fn wide_load(self, from: &[f64; WIDE_LANES], part: usize) -> Self::Wide;
    fn wide_store(self, value: Self::Wide, into: &mut [f64; WIDE_LANES], part: usize);
    fn wide_add(self, a: Self::Wide, b: Self::Wide) -> Self::Wide;
    fn wide_sub(self, a: Self::Wide, b: Self::Wide) -> Self::Wide;
    fn wide_mul(self, a: Self::Wide, b: Self::Wide) -> Self::Wide;
    /// a b + c, rounded once. Slow on processors without the instruction.
    fn wide_mul_add(self, a: Self::Wide, b: Self::Wide, c: Self::Wide) -> Self::Wide;
    fn wide_max(self, a: Self::Wide, b: Self::Wide) -> Self::Wide;
    fn wide_min(self, a: Self::Wide, b: Self::Wide) -> Self::Wide;
    fn wide_sqrt(self, a: Self::Wide) -> Self::Wide;
    /// The nearest integer to `a` (the even one of two), and `a` minus this integer. |a| must be below 2^51. The sign
    /// of a 0 depends on the instruction set.
    fn wide_split(self, a: Self::Wide) -> (Self::Wide, Self::Wide);
    /// number · 2^exponent for a positive normal number and an integer exponent of at least −2000. If the product is
    /// below the normal numbers, the result is not above 2^−1022: it may be negative or NaN. It is computed as fast as
    /// others.
    fn wide_scale_far(self, number: Self::Wide, exponent: Self::Wide) -> Self::Wide;
    /// [`wide_scale_far`](Self::wide_scale_far) where the product is a normal number.
    #[inline(always)]
    fn wide_scale(self, number: Self::Wide, exponent: Self::Wide) -> Self::Wide {
        self.wide_scale_far(number, exponent)
    }
    /// The number whose representation is `bits` minus the representation of `a`. If `bits` is the sum of the
    /// representations of b and 1, the result is b / a, or up to an eighth more.
    fn wide_opposite(self, a: Self::Wide, bits: u64) -> Self::Wide;
    /// `a` where it is above `limit`, 0 elsewhere.
    fn wide_zero_unless_above(self, a: Self::Wide, limit: Self::Wide) -> Self::Wide;

    /// A group moved up by one lane, `first` before it.
    #[inline(always)]
    fn wide_below(self, lanes: &[f64; WIDE_LANES], first: f64) -> [f64; WIDE_LANES] {
        // Destructured and rebuilt, so that the lanes are moved within registers.
        let [a, b, c, d, e, f, g, _] = *lanes;
        [first, a, b, c, d, e, f, g]
    }

    /// A group moved down by one lane, `last` after it.
    #[inline(always)]
    fn wide_above(self, lanes: &[f64; WIDE_LANES], last: f64) -> [f64; WIDE_LANES] {
        let [_, b, c, d, e, f, g, h] = *lanes;
        [b, c, d, e, f, g, h, last]
    }
}

/// A [`Kernel`](crate::Kernel) written for one register at a time, with a result. The rules of `Kernel` apply.
pub trait RegisterKernel {
    /// The result.
    type Output;
    /// The computation.
    fn run<R: Register>(self, register: R) -> Self::Output;
}
