//! Which vector instructions there are, and running a kernel with them.

use std::fmt;

/// Vector instructions that the kernels can be run with.
///
/// The choice changes the speed, and results in the last bits: AVX2 and AVX-512 round a product and its sum once, the
/// portable code twice.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[non_exhaustive]
pub enum InstructionSet {
    /// What the program was compiled for: plain loops, on any machine.
    Portable,
    /// 256-bit vectors with fused multiplication (x86-64-v3).
    Avx2,
    /// 512-bit vectors (x86-64-v4).
    Avx512,
}

impl InstructionSet {
    const ALL: [Self; 3] = [Self::Portable, Self::Avx2, Self::Avx512];

    /// The fastest of this machine.
    pub fn detect() -> Self {
        let available = Self::ALL.into_iter().rev().find(|set| set.is_available());
        available.unwrap_or(Self::Portable)
    }

    /// All that this machine has, slowest first.
    pub fn available() -> Vec<Self> {
        let all = Self::ALL.into_iter();
        all.filter(|set| set.is_available()).collect()
    }

    /// Whether this machine has it.
    pub fn is_available(self) -> bool {
        match self {
            Self::Portable => true,
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma"),
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 => {
                Self::Avx2.is_available()
                    && is_x86_feature_detected!("avx512f")
                    && is_x86_feature_detected!("avx512bw")
                    && is_x86_feature_detected!("avx512dq")
                    && is_x86_feature_detected!("avx512vl")
            }
            #[cfg(not(target_arch = "x86_64"))]
            Self::Avx2 | Self::Avx512 => false,
        }
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

/// A computation that is compiled once for each instruction set.
///
/// `run` must be `#[inline(always)]`, and so must everything it calls with lanes: code that is not inlined is not
/// compiled for the instruction set. `FUSED` says that the set has a fused multiplication.
pub(crate) trait Kernel {
    fn run<const FUSED: bool>(self);
}

/// An instruction set that the machine has been seen to have.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Dispatch(InstructionSet);

impl Dispatch {
    /// `None` when the machine lacks `set`.
    pub(crate) fn new(set: InstructionSet) -> Option<Self> {
        set.is_available().then_some(Self(set))
    }

    /// The fastest of this machine.
    pub(crate) fn detect() -> Self {
        Self(InstructionSet::detect())
    }

    /// Runs `kernel` with the instruction set.
    #[cfg_attr(
        target_arch = "x86_64",
        expect(unsafe_code, reason = "calls of functions for more instructions")
    )]
    pub(crate) fn run<K: Kernel>(self, kernel: K) {
        match self.0 {
            InstructionSet::Portable => kernel.run::<false>(),
            #[cfg(target_arch = "x86_64")]
            // SAFETY: a `Dispatch` is made only for instructions that the machine has.
            InstructionSet::Avx2 => unsafe { with_avx2(kernel) },
            #[cfg(target_arch = "x86_64")]
            // SAFETY: as above.
            InstructionSet::Avx512 => unsafe { with_avx512(kernel) },
            #[cfg(not(target_arch = "x86_64"))]
            InstructionSet::Avx2 | InstructionSet::Avx512 => kernel.run::<false>(),
        }
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn with_avx2<K: Kernel>(kernel: K) {
    kernel.run::<true>();
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma,avx512f,avx512bw,avx512dq,avx512vl")]
fn with_avx512<K: Kernel>(kernel: K) {
    kernel.run::<true>();
}
