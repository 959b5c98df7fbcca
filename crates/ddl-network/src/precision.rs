//! The device that a network runs on, and the precision of its feed-forward blocks.

use crate::names::named;
use serde::{Deserialize, Serialize};

/// Precision of the matrix products in the feed-forward blocks, for forecasts on the CPU.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Precision {
    /// Single precision throughout: the reference.
    F32,
    /// Factors with 8 significant bits, sums in single precision. A processor without AVX-512 BF16 emulates it, with
    /// the same bits.
    Bf16,
}

impl Precision {
    /// Whether this processor has instructions for the precision.
    pub fn is_native(self) -> bool {
        match self {
            Self::F32 => true,
            Self::Bf16 => ddl_simd::PairDispatch::detect().is_native(),
        }
    }
}

named!(Precision, "precision", F32 => "f32", Bf16 => "bf16");

/// The requested device.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum DeviceChoice {
    /// CUDA when it is available, else the CPU.
    Auto,
    /// The CPU.
    Cpu,
    /// The first CUDA device; an error if there is none.
    Cuda,
}

named!(DeviceChoice, "device", Auto => "auto", Cpu => "cpu", Cuda => "cuda");
