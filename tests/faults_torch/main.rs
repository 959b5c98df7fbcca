//! What goes wrong outside while a model is trained: processes that are killed, disks that are full, files that are damaged. Each fault
//! is tried a few times here, and often by `cargo xtask faults`, which also writes down what was found.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]
#![cfg(unix)]

mod changed_bytes;
mod killed_benchmark;
mod killed_training;
mod run_folder;
