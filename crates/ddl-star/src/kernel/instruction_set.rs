//! Which vector instructions there are, and running a kernel with them.

#![expect(clippy::inline_always, reason = "kernels are compiled for the set")]

use super::portable::Portable;
use super::simd::{Kernel, PairKernel, Pairs, Simd};
#[cfg(target_arch = "x86_64")]
use super::x86::{Avx2, Avx512, Avx512Bf16};

/// Vector instructions that the kernels can be run with.
///
/// The choice changes the speed, and results in the last bits: AVX2 and AVX-512 round a product and its sum once, the
/// portable code on most machines twice.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum InstructionSet {
    /// What the program was compiled for: plain loops, on any machine.
    Portable,
    /// 256-bit vectors with fused multiplication (x86-64-v3).
    Avx2,
    /// 512-bit vectors (AVX-512 F).
    Avx512,
}

impl InstructionSet {
    /// Slowest first.
    const ALL: [Self; 3] = [Self::Portable, Self::Avx2, Self::Avx512];

    /// The fastest of this machine.
    pub(super) fn detect() -> Self {
        let fastest = Self::ALL.into_iter().rev().find(|set| set.is_available());
        fastest.unwrap_or(Self::Portable)
    }

    fn is_available(self) -> bool {
        Dispatch::new(self).is_some()
    }

    /// All that this machine has, slowest first.
    #[cfg(test)]
    pub(super) fn available() -> Vec<Self> {
        let all = Self::ALL.into_iter();
        all.filter(|set| set.is_available()).collect()
    }
}

/// An instruction set that the machine has been seen to have.
#[derive(Clone, Copy, Debug)]
pub(super) enum Dispatch {
    Portable(Portable),
    #[cfg(target_arch = "x86_64")]
    Avx2(Avx2),
    #[cfg(target_arch = "x86_64")]
    Avx512(Avx512),
}

impl Dispatch {
    /// `None` when the machine lacks `set`.
    pub(super) fn new(set: InstructionSet) -> Option<Self> {
        match set {
            InstructionSet::Portable => Some(Self::Portable(Portable)),
            #[cfg(target_arch = "x86_64")]
            InstructionSet::Avx2 => Avx2::detect().map(Self::Avx2),
            #[cfg(target_arch = "x86_64")]
            InstructionSet::Avx512 => Avx512::detect().map(Self::Avx512),
            #[cfg(not(target_arch = "x86_64"))]
            InstructionSet::Avx2 | InstructionSet::Avx512 => None,
        }
    }

    /// The fastest of this machine.
    pub(super) fn detect() -> Self {
        Self::new(InstructionSet::detect()).unwrap_or(Self::Portable(Portable))
    }

    /// Runs `kernel` with the instruction set.
    #[inline]
    pub(super) fn run<K: Kernel>(self, kernel: K) {
        match self {
            Self::Portable(simd) => simd.run(kernel),
            #[cfg(target_arch = "x86_64")]
            Self::Avx2(simd) => simd.run(kernel),
            #[cfg(target_arch = "x86_64")]
            Self::Avx512(simd) => simd.run(kernel),
        }
    }
}

/// How pairs of bf16 numbers are computed with: all ways give the same bits.
#[derive(Clone, Copy, Debug)]
pub(super) enum PairDispatch {
    /// By portable code, compiled for the instruction set.
    Emulated(Dispatch),
    #[cfg(target_arch = "x86_64")]
    Avx512Bf16(Avx512Bf16),
}

impl PairDispatch {
    /// The fastest of this machine.
    pub(super) fn detect() -> Self {
        #[cfg(target_arch = "x86_64")]
        if let Some(pairs) = Avx512Bf16::detect() {
            return Self::Avx512Bf16(pairs);
        }
        Self::Emulated(Dispatch::detect())
    }

    /// Whether the machine has instructions for it.
    pub(super) fn is_native(self) -> bool {
        !matches!(self, Self::Emulated(_))
    }

    /// Runs `kernel`.
    #[inline]
    pub(super) fn run<K: PairKernel>(self, kernel: K) {
        match self {
            Self::Emulated(dispatch) => dispatch.run(Emulated(kernel)),
            #[cfg(target_arch = "x86_64")]
            Self::Avx512Bf16(pairs) => pairs.run_pairs(kernel),
        }
    }
}

/// Takes nothing of an instruction set but what the compiler makes of it.
struct Emulated<K>(K);

impl<K: PairKernel> Kernel for Emulated<K> {
    #[inline(always)]
    fn run<S: Simd>(self, _: S) {
        Portable.run_pairs(self.0);
    }
}
