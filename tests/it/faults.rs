//! External faults: full disks, damaged files, closed outputs, crowds, days of input. Each fault is tried a few times
//! here, and many times with `DDL_NIGHTLY` (`cargo xtask nightly faults`).

mod changed_bytes;
mod crowds;
mod disk_full;
mod forged_paths;
mod gone_readers;
mod long_stream;
mod no_network;
mod unwritable;

const EVALUATE: &str = "evaluate --model run --protocol fair --test-pedestrians 20 --threads 1";
