//! Sixteen numbers at a time: the arithmetic of the kernels, on whatever vector instructions the machine has.
//!
//! Data lie in groups of sixteen lanes on every machine. A kernel is written once, as a [`Kernel`], for any [`Simd`]: it
//! goes through a group in [`Simd::PARTS`] parts of [`Simd::WIDTH`] lanes, the size of one register. [`Dispatch::run`]
//! compiles it for each instruction set and picks the one that was chosen.
//!
//! A value of a type that implements [`Simd`] is the proof that the machine has the instructions, so that all methods are
//! safe to call. What is `unsafe` lies in one module.
//!
//! # Numerics
//! `f64` operations are rounded one by one (there is no fused multiplication), so that every instruction set gives the
//! same bits. `f32` operations may be fused and may differ in the last bits; they obey the same error bounds.

mod dispatch;
mod exp2;
mod portable;
#[cfg(target_arch = "x86_64")]
mod x86;

pub use dispatch::InstructionSet;
pub(crate) use dispatch::{Dispatch, Kernel};
pub(crate) use exp2::{COST_LIMIT, COST_LIMIT_64, EXP2_ERROR, EXP2_ERROR_64};

/// Numbers in a group.
pub(crate) const LANES: usize = 16;
/// Bound on what [`Simd::cell`] adds to a sum of predecessors, on any machine: times 2^−[`COST_LIMIT`] it is a normal
/// number.
pub(crate) const FLOOR: f32 = 0.25;
/// One number for each of sixteen candidates.
pub(crate) type Lanes = [f32; LANES];
/// Wide numbers in a group: what fills the registers of one part of [`Lanes`] holds half as many of them.
pub(crate) const WIDE_LANES: usize = LANES / 2;
/// One wide number for each of eight candidates.
pub(crate) type WideLanes = [f64; WIDE_LANES];

/// Vector arithmetic of one instruction set.
///
/// Loads and stores touch the lanes `part * WIDTH ..` of a group (`part * WIDTH / 2 ..` of a wide one) and panic when
/// `part >= PARTS`, a check that disappears in a loop over `0..PARTS`.
pub(crate) trait Simd: Copy {
    /// `WIDTH` numbers in `f32`.
    type Narrow: Copy;
    /// `WIDTH / 2` numbers in `f64`.
    type Wide: Copy;
    /// Lanes of a register.
    const WIDTH: usize;
    /// What [`Simd::cell`] adds to a sum of predecessors, at most: [`FLOOR`] or less.
    const FLOOR: f32;
    /// Registers that make up a group.
    const PARTS: usize = LANES / Self::WIDTH;

    /// Compiles `kernel` with this instruction set and runs it.
    fn run<K: Kernel>(self, kernel: K) -> K::Output;

    fn splat(self, value: f32) -> Self::Narrow;
    fn load(self, from: &Lanes, part: usize) -> Self::Narrow;
    fn store(self, value: Self::Narrow, into: &mut Lanes, part: usize);
    fn add(self, a: Self::Narrow, b: Self::Narrow) -> Self::Narrow;
    fn sub(self, a: Self::Narrow, b: Self::Narrow) -> Self::Narrow;
    fn mul(self, a: Self::Narrow, b: Self::Narrow) -> Self::Narrow;
    fn div(self, a: Self::Narrow, b: Self::Narrow) -> Self::Narrow;
    /// a b + c, rounded once or twice.
    fn mul_add(self, a: Self::Narrow, b: Self::Narrow, c: Self::Narrow) -> Self::Narrow;
    /// c − a b, rounded once or twice.
    fn neg_mul_add(self, a: Self::Narrow, b: Self::Narrow, c: Self::Narrow) -> Self::Narrow;
    /// The larger of each two numbers; `b` where `a` is NaN.
    fn max(self, a: Self::Narrow, b: Self::Narrow) -> Self::Narrow;
    /// Bit l is set where a >= b in lane l of the part.
    fn at_least(self, a: Self::Narrow, b: Self::Narrow) -> u32;
    /// Adds the low bits of `exponent`'s representation to the exponent of `power`.
    fn scale(self, power: Self::Narrow, exponent: Self::Narrow) -> Self::Narrow;

    /// 2^`exponent` for exponents that are not positive, to a relative error of [`EXP2_ERROR`].
    ///
    /// Exponents below −[`COST_LIMIT`] (and NaN) count as −[`COST_LIMIT`]: no result is denormal.
    #[expect(clippy::inline_always, reason = "the lanes must stay in registers")]
    #[inline(always)]
    fn exp2(self, exponent: Self::Narrow) -> Self::Narrow {
        let [power] = self.exp2_each([exponent]);
        power
    }

    /// [`Simd::exp2`] of several registers, a stage at a time, so that none waits for the others.
    #[expect(clippy::inline_always, reason = "the lanes must stay in registers")]
    #[inline(always)]
    fn exp2_each<const G: usize>(self, exponents: [Self::Narrow; G]) -> [Self::Narrow; G] {
        exp2::by_rounding(self, exponents)
    }

    /// K b for K of at least 2^−[`COST_LIMIT`], with up to [`Simd::FLOOR`] added to b so that the product is not denormal.
    fn weigh(self, k: Self::Narrow, b: Self::Narrow) -> Self::Narrow;

    /// K (diagonal + up + left), one cell of the recursion, for K of at least 2^−[`COST_LIMIT`]. Up to [`Simd::FLOOR`] is
    /// added to the sum, so that no product is denormal: denormal numbers would make the recursion ten times slower.
    fn cell(
        self,
        k: Self::Narrow,
        diagonal: Self::Narrow,
        up: Self::Narrow,
        left: Self::Narrow,
    ) -> Self::Narrow;

    fn wide_splat(self, value: f64) -> Self::Wide;
    fn wide_load(self, from: &WideLanes, part: usize) -> Self::Wide;
    fn wide_store(self, value: Self::Wide, into: &mut WideLanes, part: usize);
    fn wide_add(self, a: Self::Wide, b: Self::Wide) -> Self::Wide;
    fn wide_sub(self, a: Self::Wide, b: Self::Wide) -> Self::Wide;
    fn wide_mul(self, a: Self::Wide, b: Self::Wide) -> Self::Wide;
    /// The larger of each two numbers; `b` where `a` is NaN.
    fn wide_max(self, a: Self::Wide, b: Self::Wide) -> Self::Wide;
    fn wide_sqrt(self, a: Self::Wide) -> Self::Wide;
    /// Adds the low bits of `exponent`'s representation to the exponent of `power`.
    fn wide_scale(self, power: Self::Wide, exponent: Self::Wide) -> Self::Wide;

    /// 2^exponent for exponents that are not positive, to a relative error of [`EXP2_ERROR_64`], of several registers.
    ///
    /// Exponents below −[`COST_LIMIT_64`] (and NaN) count as −[`COST_LIMIT_64`]: no result is denormal.
    #[expect(clippy::inline_always, reason = "the lanes must stay in registers")]
    #[inline(always)]
    fn wide_exp2_each<const G: usize>(self, exponents: [Self::Wide; G]) -> [Self::Wide; G] {
        exp2::wide_by_rounding(self, exponents)
    }
}

#[cfg(test)]
mod tests;
