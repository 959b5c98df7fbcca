//! Where a network shall compute.

use crate::names::named;
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

named!(DeviceChoice, "device", Auto => "auto", Cpu => "cpu", Cuda => "cuda");
