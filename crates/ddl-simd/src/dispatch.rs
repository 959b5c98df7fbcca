//! The instruction sets of the processor, and running kernels with one.

use crate::simd::Kernel;
use fearless_simd::Level;
#[cfg(target_arch = "x86_64")]
use fearless_simd::Simd as _;

/// Instruction sets that kernels can run with.
///
/// # Examples
/// ```
/// use ddl_simd::{Dispatch, InstructionSet};
/// assert_eq!(InstructionSet::available().last(), Some(&Dispatch::detect().instruction_set()));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[non_exhaustive]
pub enum InstructionSet {
    /// The baseline of the target: SSE2 or NEON, otherwise plain loops.
    Portable,
    /// 256-bit vectors with fused multiplication (x86-64-v3).
    Avx2,
    /// 512-bit vectors (AVX-512 of Ice Lake, Zen 4 and later).
    Avx512,
}

impl InstructionSet {
    /// All instruction sets of this machine, slowest first.
    pub fn available() -> Vec<Self> {
        [Self::Portable, Self::Avx2, Self::Avx512].into_iter().filter(|&set| Dispatch::new(set).is_some()).collect()
    }
}

/// An instruction set that the machine is known to have.
#[derive(Clone, Copy, Debug)]
pub struct Dispatch(Level);

impl Dispatch {
    /// `None` if the machine lacks `set`.
    pub fn new(set: InstructionSet) -> Option<Self> {
        let level = match set {
            #[cfg(not(target_arch = "x86_64"))]
            InstructionSet::Portable => Some(Level::baseline()),
            #[cfg(target_arch = "x86_64")]
            InstructionSet::Portable => Level::new().as_sse2().map(Level::Sse2),
            #[cfg(target_arch = "x86_64")]
            InstructionSet::Avx2 => Level::new().as_avx2().map(Level::Avx2),
            #[cfg(target_arch = "x86_64")]
            InstructionSet::Avx512 => Level::new().as_avx512().map(Level::Avx512),
            #[cfg(not(target_arch = "x86_64"))]
            InstructionSet::Avx2 | InstructionSet::Avx512 => None,
        };
        level.map(Self)
    }

    /// The fastest one of this machine.
    #[inline]
    pub fn detect() -> Self {
        Self(Level::new())
    }

    /// The instruction set.
    pub fn instruction_set(self) -> InstructionSet {
        match self.0 {
            #[cfg(target_arch = "x86_64")]
            Level::Avx512(_) => InstructionSet::Avx512,
            #[cfg(target_arch = "x86_64")]
            Level::Avx2(_) => InstructionSet::Avx2,
            _ => InstructionSet::Portable,
        }
    }

    /// Runs `kernel` with the instruction set.
    #[inline]
    pub fn run<K: Kernel>(self, kernel: K) {
        // The library's own dispatch would also compile a kernel for SSE4.2, which is no faster than SSE2 here.
        #[cfg(target_arch = "x86_64")]
        match self.0 {
            Level::Avx512(simd) => simd.vectorize(
                #[inline(always)]
                || kernel.run(simd),
            ),
            Level::Avx2(simd) => simd.vectorize(
                #[inline(always)]
                || kernel.run(simd),
            ),
            level => {
                let Some(simd) = level.as_sse2() else { unreachable!("every x86-64 processor has SSE2") };
                simd.vectorize(
                    #[inline(always)]
                    || kernel.run(simd),
                );
            }
        }
        #[cfg(not(target_arch = "x86_64"))]
        fearless_simd::dispatch!(self.0, simd => kernel.run(simd));
    }
}
