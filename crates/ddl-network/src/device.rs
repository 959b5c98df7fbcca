//! The device that a network runs on.

use ddl_core::named;
use serde::{Deserialize, Serialize};

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
