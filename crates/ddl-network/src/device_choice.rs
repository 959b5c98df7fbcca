//! Where a network shall compute.

use crate::NetworkError;
use serde::{Deserialize, Serialize};

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

impl std::fmt::Display for DeviceChoice {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Auto => "auto",
            Self::Cpu => "cpu",
            Self::Cuda => "cuda",
        })
    }
}

impl std::str::FromStr for DeviceChoice {
    type Err = NetworkError;

    fn from_str(text: &str) -> Result<Self, NetworkError> {
        match text {
            "auto" => Ok(Self::Auto),
            "cpu" => Ok(Self::Cpu),
            "cuda" => Ok(Self::Cuda),
            _ => Err(NetworkError::Config {
                field: "device",
                value: text.to_owned(),
                rule: "one of auto, cpu, cuda",
            }),
        }
    }
}
