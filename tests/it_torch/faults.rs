//! External faults during training: killed processes, full disks, damaged files. Each fault is tried a few times here,
//! and many times with `DDL_NIGHTLY` (`cargo xtask nightly faults`).

mod changed_bytes;
mod killed_benchmark;
mod killed_training;
mod run_folder;
