//! Products of 32 x 32 matrices of `f32` on a matrix unit that multiplies bf16 numbers.

#![expect(clippy::inline_always, reason = "the lanes must stay in registers")]

use crate::block::{BLOCK, Block, Panel};
use crate::simd::Simd;

/// Number of bf16 numbers whose sum is an `f32`.
pub(crate) const PIECES: usize = 3;

/// 32 numbers of bf16.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub struct Line(pub(crate) [u16; BLOCK]);

impl Line {
    const ZERO: Self = Self([0; BLOCK]);
}

/// The left factor of a product: the rows of the first pieces, then those of the second and of the third.
#[derive(Clone, Debug)]
pub struct LeftFactor(pub(crate) [[Line; BLOCK]; PIECES]);

/// The right factor of a product: two halves of sixteen columns for each piece. A line holds pairs of the numbers of
/// two rows.
#[derive(Clone, Debug)]
pub struct RightFactor(pub(crate) [[[Line; BLOCK / 2]; 2]; PIECES]);

impl LeftFactor {
    /// The matrix of zeros.
    pub const ZERO: Self = Self([[Line::ZERO; BLOCK]; PIECES]);

    /// Writes both halves of a row.
    #[inline(always)]
    pub fn set_row<U: MatrixUnit>(&mut self, unit: U, row: usize, [low, high]: [&Pieces<U>; 2]) {
        for p in 0..PIECES {
            unit.in_sequence(low[p], high[p], &mut self.0[p][row]);
        }
    }
}

impl RightFactor {
    /// The matrix of zeros.
    pub const ZERO: Self = Self([[[Line::ZERO; BLOCK / 2]; 2]; PIECES]);

    /// Writes half `half` of the rows 2 `pair` and 2 `pair` + 1.
    #[inline(always)]
    pub fn set_rows<U: MatrixUnit>(&mut self, unit: U, pair: usize, half: usize, [even, odd]: [&Pieces<U>; 2]) {
        for p in 0..PIECES {
            unit.in_pairs(even[p], odd[p], &mut self.0[p][half][pair]);
        }
    }
}

/// What products are added to.
#[derive(Clone, Copy, Debug)]
pub enum Start<'a> {
    /// The same numbers in every row.
    Row(&'a Block),
    /// A matrix.
    Panel(&'a Panel),
}

/// Arithmetic of a matrix unit for bf16 numbers, in addition to that on `f32`.
///
/// An `f32` is the sum of three bf16 numbers of 8 significant bits. A product of two matrices is the sum of six
/// products of their pieces; the three smallest of nine are left out.
///
/// # Numerics
/// What is left out of a product of two numbers is at most 1.01 · 2^−24 of it. Of a product of matrices, 18 roundings
/// are relative to the sum of its terms, and 6 to the sum so far. Numbers below 2^−102 lose digits;
/// those of at least 2^127 may become NaN.
pub trait MatrixUnit: Copy + Send + Sync {
    /// The arithmetic on `f32`.
    type Simd: Simd;

    /// The arithmetic on `f32`.
    fn simd(self) -> Self::Simd;

    /// Numbers whose upper halves have the sum `a`.
    fn pieces(self, a: UnitFloats<Self>) -> Pieces<Self>;
    /// The upper halves of `a`, then those of `b`.
    fn in_sequence(self, a: UnitFloats<Self>, b: UnitFloats<Self>, into: &mut Line);
    /// The upper halves of number 0 of `a` and of `b`, then of number 1 of both, and so on.
    fn in_pairs(self, a: UnitFloats<Self>, b: UnitFloats<Self>, into: &mut Line);
    /// Sets the sum of the unit. It keeps it until the next call, but not beyond the kernel.
    fn start(self, start: Start<'_>);
    /// Adds a b to the sum of the unit.
    fn add_product(self, a: &LeftFactor, b: &RightFactor);
    /// Writes the sum of the unit.
    fn store(self, sum: &mut Panel);
}

/// Sixteen `f32` of the arithmetic of `U`.
pub type UnitFloats<U> = <<U as MatrixUnit>::Simd as Simd>::Floats;

/// Sixteen `f32` in pieces.
pub type Pieces<U> = [UnitFloats<U>; PIECES];

/// A computation with a matrix unit. The rules of [`Kernel`](crate::Kernel) apply.
pub trait MatrixKernel {
    /// The computation.
    fn run<U: MatrixUnit>(self, unit: U);
}
