//! One metric a file, each with its formula, unit and source.
//!
//! All are functions of a [`Scene`](crate::Scene): N pedestrians, K hypotheses, 12 frames, metres.

pub mod calibration;
pub mod collision;
pub mod displacement;
pub mod goal;
pub mod joint;
pub mod miss;
pub mod stability;

#[cfg(test)]
pub(crate) mod fixture;
