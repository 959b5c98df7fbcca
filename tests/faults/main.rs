//! What goes wrong outside: disks that are full, files that are damaged, readers that go, crowds, days. Each fault is
//! tried a few times here, and often by `cargo xtask faults`, which also writes down what was found.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]
#![cfg(unix)]

mod changed_bytes;
mod crowds;
mod disk_full;
mod forged_paths;
mod gone_readers;
mod long_stream;
mod no_network;
mod unwritable;

/// What is measured of the model in `run`.
const EVALUATE: &str = "evaluate --model run --protocol fair --test-pedestrians 20 --threads 1";
