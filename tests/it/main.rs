//! Tests across crates that need no libtorch.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

mod certified_flow;
mod examples;
mod golden_forecasts;
mod guarantee_on_real_people;
mod leak_baselines;
mod leak_goals;
mod leak_is_caught;
mod other_program;
mod outside_bytes;
