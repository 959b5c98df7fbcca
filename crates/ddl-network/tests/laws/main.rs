//! Properties of networks with any weights, on simulated crowds.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod bounded;
mod company;
mod moved;
mod proposals;
mod refused;
mod same_bits;
mod scenes;
mod sizes;
mod weight_files;
