//! Tests across crates and of the program `ddl` that need no libtorch.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod bounded_motion;
mod cameras;
mod errors;
mod evaluate;
mod examples;
mod forecast;
mod golden_forecasts;
mod guarantee_on_real_people;
#[cfg(unix)]
mod guide;
mod keep_clear;
mod kept_memory;
mod leak;
mod leak_in_reports;
mod live;
mod live_memory;
mod manners;
mod other_program;
mod own_recordings;
mod packed;
mod packed_benchmark;
mod regions;
mod tracks_as_they_come;

#[test]
fn readers_handle_their_corpora_and_edits_of_them() {
    for reader in ddl_tests::outside_bytes::READERS {
        ddl_tests::outside_bytes::corpus::run(reader);
    }
}
