//! Laws of the kernels, and agreement with plain formulas in f64.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod among_walkers;
mod laws;
mod numbers;
mod over_memory;
mod reference;
