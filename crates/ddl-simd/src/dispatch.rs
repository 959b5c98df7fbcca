//! Detection of vector instructions at run time, and dispatch of kernels.

#![expect(clippy::inline_always, reason = "compiled per instruction set")]

use std::fmt;

use crate::portable::Portable;
use crate::register::{Register, RegisterKernel};
use crate::simd::Kernel;
#[cfg(target_arch = "x86_64")]
use crate::x86::{Avx2, Avx512};

/// Instruction sets that kernels can run with.
///
/// # Examples
/// ```
/// use ddl_simd::InstructionSet;
/// let best = InstructionSet::detect();
/// assert!(best.is_available() && InstructionSet::Portable.is_available());
/// assert!(InstructionSet::available().contains(&best));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[non_exhaustive]
pub enum InstructionSet {
    /// The instructions that the program was compiled for: plain loops, on any machine.
    Portable,
    /// 256-bit vectors with fused multiplication (x86-64-v3).
    Avx2,
    /// 512-bit vectors (AVX-512 F and DQ).
    Avx512,
}

impl InstructionSet {
    const ALL: [Self; 3] = [Self::Portable, Self::Avx2, Self::Avx512];

    /// The fastest one of this machine.
    pub fn detect() -> Self {
        let available = Self::ALL.into_iter().rev().find(|set| set.is_available());
        available.unwrap_or(Self::Portable)
    }

    /// All instruction sets of this machine, slowest first.
    pub fn available() -> Vec<Self> {
        let all = Self::ALL.into_iter();
        all.filter(|set| set.is_available()).collect()
    }

    /// Whether this machine has the instruction set.
    pub fn is_available(self) -> bool {
        Dispatch::new(self).is_some()
    }
}

impl fmt::Display for InstructionSet {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Portable => "portable",
            Self::Avx2 => "AVX2",
            Self::Avx512 => "AVX-512",
        })
    }
}

/// An instruction set that the machine is known to have.
#[derive(Clone, Copy, Debug)]
pub struct Dispatch(Set);

#[derive(Clone, Copy, Debug)]
enum Set {
    Portable(Portable),
    #[cfg(target_arch = "x86_64")]
    Avx2(Avx2),
    #[cfg(target_arch = "x86_64")]
    Avx512(Avx512),
}

impl Dispatch {
    /// `None` if the machine lacks `set`.
    pub fn new(set: InstructionSet) -> Option<Self> {
        let set = match set {
            InstructionSet::Portable => Some(Set::Portable(Portable)),
            #[cfg(target_arch = "x86_64")]
            InstructionSet::Avx2 => Avx2::detect().map(Set::Avx2),
            #[cfg(target_arch = "x86_64")]
            InstructionSet::Avx512 => Avx512::detect().map(Set::Avx512),
            #[cfg(not(target_arch = "x86_64"))]
            InstructionSet::Avx2 | InstructionSet::Avx512 => None,
        };
        set.map(Self)
    }

    /// The fastest one of this machine.
    pub fn detect() -> Self {
        Self::new(InstructionSet::detect()).unwrap_or(Self(Set::Portable(Portable)))
    }

    /// The instruction set.
    pub fn instruction_set(self) -> InstructionSet {
        match self.0 {
            Set::Portable(_) => InstructionSet::Portable,
            #[cfg(target_arch = "x86_64")]
            Set::Avx2(_) => InstructionSet::Avx2,
            #[cfg(target_arch = "x86_64")]
            Set::Avx512(_) => InstructionSet::Avx512,
        }
    }

    /// [`Register::FUSED`] of the instruction set.
    pub fn is_fused(self) -> bool {
        self.run_on_registers(AskFused)
    }

    /// Runs `kernel` with the instruction set, sixteen numbers at a time.
    #[inline]
    pub fn run<K: Kernel>(self, kernel: K) {
        self.run_on_registers(OnSixteen(kernel));
    }

    /// Runs `kernel` with the instruction set, one register at a time.
    #[inline]
    pub fn run_on_registers<K: RegisterKernel>(self, kernel: K) -> K::Output {
        match self.0 {
            Set::Portable(register) => register.run(kernel),
            #[cfg(target_arch = "x86_64")]
            Set::Avx2(register) => register.run(kernel),
            #[cfg(target_arch = "x86_64")]
            Set::Avx512(register) => register.run(kernel),
        }
    }
}

struct OnSixteen<K>(K);

impl<K: Kernel> RegisterKernel for OnSixteen<K> {
    type Output = ();

    #[inline(always)]
    fn run<R: Register>(self, register: R) {
        self.0.run(register.sixteen());
    }
}

struct AskFused;

impl RegisterKernel for AskFused {
    type Output = bool;

    #[inline(always)]
    fn run<R: Register>(self, _: R) -> bool {
        R::FUSED
    }
}
