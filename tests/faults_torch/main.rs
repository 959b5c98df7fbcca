//! External faults during training: killed processes, full disks, damaged files. Each fault is tried a few times here.
//! `cargo xtask nightly faults` tries it many times and records the results.

#![allow(clippy::unwrap_used, reason = "a test may panic")]
#![cfg(unix)]

mod changed_bytes;
mod killed_benchmark;
mod killed_training;
mod run_folder;
