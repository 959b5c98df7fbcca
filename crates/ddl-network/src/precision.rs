//! How exactly the heavy products of the network are computed.

use crate::NetworkError;

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
    /// "f32" or "bf16".
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::F32 => "f32",
            Self::Bf16 => "bf16",
        }
    }

    /// Whether this machine has instructions for it.
    #[must_use]
    pub fn is_native(self) -> bool {
        match self {
            Self::F32 => true,
            Self::Bf16 => ddl_simd::PairDispatch::detect().is_native(),
        }
    }
}

impl std::str::FromStr for Precision {
    type Err = NetworkError;

    fn from_str(text: &str) -> Result<Self, NetworkError> {
        match text {
            "f32" => Ok(Self::F32),
            "bf16" => Ok(Self::Bf16),
            _ => Err(NetworkError::Config {
                field: "precision",
                value: text.to_owned(),
                rule: "one of f32, bf16",
            }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_read() {
        for precision in [Precision::F32, Precision::Bf16] {
            assert_eq!(precision.name().parse::<Precision>().unwrap(), precision);
        }
        let error = "f16".parse::<Precision>().unwrap_err().to_string();
        assert!(error.contains("f16") && error.contains("bf16"), "{error}");
    }
}
