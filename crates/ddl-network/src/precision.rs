//! How exactly the heavy products of the network are computed.

use crate::names::named;

/// Precision of the products in the feed-forward blocks of forecasts, on the CPU.
///
/// A choice of the one who computes, not of the model: weights, and all else that is computed, are what they are without it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Precision {
    /// Single precision throughout: the reference.
    F32,
    /// Factors with 8 significant bits, sums in single precision. Fast on processors with AVX-512 BF16; emulated on others,
    /// bit for bit and slowly.
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
