//! What goes wrong outside: processes that are killed, disks that are full, files that are damaged, crowds, days. Each fault is
//! tried a few times here, and often by `cargo xtask faults`, which also writes down what was found.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]
#![cfg(unix)]

mod changed_bytes;
mod crowds;
mod disk_full;
mod forged_paths;
mod gone_readers;
mod killed_benchmark;
mod killed_training;
mod long_stream;
mod no_network;
mod two_at_once;
mod unwritable;

use ddl_tests::folder_contents;
use ddl_tests::tiny_model::folder_with_model;
use std::path::Path;

/// Training of some seconds: 12 steps of the proposal network, then 3 epochs of 8 steps.
const TRAIN: &str = "train --convention simulated --fold doorway --epochs 3 --train-walkers 128 \
                     --batch-walkers 16 --proposal-steps 12 --threads 1 --out run";

/// Files under temporary names anywhere below a folder: what was being written.
fn half_written(folder: &Path) -> Vec<String> {
    let contents = folder_contents::read(folder);
    let names = contents.keys().map(|name| name.display().to_string());
    names
        .filter(|name| {
            [".writing-", ".report-", ".tmp"]
                .iter()
                .any(|mark| name.contains(mark))
        })
        .collect()
}

/// Numbers that differ from run to run and are told, so that a failure can be had again.
struct Chance(u64);

impl Chance {
    fn new(what: &str) -> Self {
        let seed = std::hash::BuildHasher::hash_one(&std::hash::RandomState::new(), what);
        eprintln!("{what}: seed {seed}");
        Self(seed)
    }

    /// A whole number below `limit`.
    fn below(&mut self, limit: u64) -> u64 {
        // the finaliser of splitmix64
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (z ^ (z >> 31)) % limit.max(1)
    }

    /// A moment of the `index`-th of `count` equal parts of a time.
    fn moment(
        &mut self,
        (index, count): (usize, usize),
        of: std::time::Duration,
    ) -> std::time::Duration {
        let part = of / u32::try_from(count).unwrap();
        let within = self.below(u64::try_from(part.as_micros()).unwrap());
        part * u32::try_from(index).unwrap() + std::time::Duration::from_micros(within)
    }
}
