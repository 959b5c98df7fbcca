//! The metrics, each with its formula, unit and source.
//!
//! All are functions of a [`ScoredWindow`](crate::ScoredWindow): N pedestrians, K hypotheses, 12 frames, metres.

pub mod amd;
pub mod collision;
pub mod deployable;
pub mod displacement;
pub mod diversity;
pub(crate) mod gaussian;
pub mod joint;
pub mod kde;
pub mod region;
pub mod reliability;
pub mod stability;

#[cfg(test)]
mod tests;
