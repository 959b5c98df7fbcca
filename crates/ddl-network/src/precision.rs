//! Where a network shall compute, and how exactly its heavy products.

use crate::names::named;
use serde::{Deserialize, Serialize};

/// Precision of the products in the feed-forward blocks of forecasts, on the CPU.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Precision {
    /// Single precision throughout: the reference.
    F32,
    /// Factors with 8 significant bits, sums in single precision; emulated, bit for bit, without AVX-512 BF16.
    Bf16,
}

impl Precision {
    /// Whether this machine has instructions for it.
    pub fn is_native(self) -> bool {
        match self {
            Self::F32 => true,
            Self::Bf16 => ddl_simd::PairDispatch::detect().is_native(),
        }
    }
}

named!(Precision, "precision", F32 => "f32", Bf16 => "bf16");

/// The device asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum DeviceChoice {
    /// CUDA when it can be had, else the CPU.
    Auto,
    /// The CPU.
    Cpu,
    /// The first CUDA device; its absence is an error.
    Cuda,
}

named!(DeviceChoice, "device", Auto => "auto", Cpu => "cpu", Cuda => "cuda");
