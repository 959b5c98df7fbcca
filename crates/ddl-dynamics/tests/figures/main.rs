//! The pictures of `docs/stability.md` are those that the examples draw, and show what the rollouts do.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod around;
mod circling;
#[path = "../../examples/drawing/mod.rs"]
mod drawing;
mod svg;
