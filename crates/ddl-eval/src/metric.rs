//! The metrics, each with its formula, unit and source.
//!
//! All are functions of a [`Scene`](crate::Scene): N pedestrians, K hypotheses, 12 frames, metres.

pub mod amd;
pub mod calibration;
pub mod collision;
pub mod displacement;
pub mod diversity;
pub mod gaussian;
pub mod kde;
pub mod region;
pub mod stability;
