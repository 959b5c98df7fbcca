//! The arithmetic of the kernels, on whatever vector instructions the machine has.

use super::Block;

/// Random bits of one group of units: see [`dropout`](super::dropout).
pub(crate) const LANES: usize = 16;

/// Accumulators of a product: `R` rows of `V` registers.
pub(crate) type Tile<S, const R: usize, const V: usize> = [[<S as Simd>::Floats; V]; R];

/// Vector arithmetic of one instruction set.
///
/// A value of a type that implements it is the proof that the machine has the instructions, so that all methods are safe
/// to call. Loads and stores touch the numbers `part * WIDTH ..` of a block and panic when it has no such part, a check
/// that disappears where the part is known to the compiler.
pub(crate) trait Simd: Copy + Send + Sync {
    /// `WIDTH` numbers.
    type Floats: Copy;
    /// `WIDTH` words of 32 bits.
    type Bits: Copy;
    /// Lanes of a register, 16 or a divisor of it.
    const WIDTH: usize;

    /// Compiles `kernel` with this instruction set and runs it.
    fn run<K: Kernel>(self, kernel: K) -> K::Output;

    fn splat(self, value: f32) -> Self::Floats;
    fn load(self, from: &Block, part: usize) -> Self::Floats;
    fn store(self, value: Self::Floats, into: &mut Block, part: usize);
    fn add(self, a: Self::Floats, b: Self::Floats) -> Self::Floats;
    fn mul(self, a: Self::Floats, b: Self::Floats) -> Self::Floats;
    /// a b + c, rounded once or twice.
    fn mul_add(self, a: Self::Floats, b: Self::Floats, c: Self::Floats) -> Self::Floats;
    /// The larger of 0 and `a`; NaN where `a` is NaN.
    fn relu(self, a: Self::Floats) -> Self::Floats;
    /// 0 where `condition` <= 0, `a` elsewhere (also where `condition` is NaN).
    fn zero_unless_positive(self, condition: Self::Floats, a: Self::Floats) -> Self::Floats;

    /// Lane l is `first` xor (`part * WIDTH` + l).
    fn count_from(self, first: u32, part: usize) -> Self::Bits;
    fn xor(self, a: Self::Bits, b: u32) -> Self::Bits;
    /// a xor (a >> `N`).
    fn xor_shift<const N: u32>(self, a: Self::Bits) -> Self::Bits;
    fn shift_left<const N: u32>(self, a: Self::Bits) -> Self::Bits;
    /// The low 32 bits of the product.
    fn mul_low(self, a: Self::Bits, b: u32) -> Self::Bits;
    /// `a` where `bits` >= `least`, 0 elsewhere.
    fn keep(self, a: Self::Floats, bits: Self::Bits, least: u32) -> Self::Floats;
}

/// A computation that is compiled once for each instruction set.
///
/// `run` must be `#[inline(always)]`, and so must everything it calls with vectors: code that is not inlined, closures
/// included, is not compiled for the instruction set. `R` and `V` are the size of the [`Tile`] of accumulators that the
/// registers hold; `R` divides [`ROWS`], `V` the registers of a block.
pub(crate) trait Kernel {
    type Output;
    fn run<S: Simd, const R: usize, const V: usize>(self, simd: S) -> Self::Output;
}

/// A multiple of the rows of every instruction set's tile.
pub(crate) const ROWS: usize = 8;
