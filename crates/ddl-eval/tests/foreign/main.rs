//! Forecasts of another program: every format reads the same, and every mistake is named with its place.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod files;
mod laws;
mod matching;
mod mistakes;
