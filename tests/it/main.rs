//! Tests across crates and of the program `ddl` that need no libtorch.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod bounded_motion;
mod cameras;
mod errors;
mod evaluate;
mod every_command;
mod examples;
#[cfg(unix)]
mod faults;
mod finished_benchmark;
mod first_row;
mod forecast;
mod golden_forecasts;
#[cfg(unix)]
mod guide;
mod kept_memory;
mod known_recordings;
mod leak;
mod live;
mod live_memory;
mod logs;
mod other_program;
mod own_recordings;
mod packed;
mod refusals;
mod regions;
mod scenes;
mod tracks_as_they_come;

#[test]
fn readers_handle_edited_files() {
    ddl_tests::outside_bytes::READERS.into_iter().for_each(ddl_tests::outside_bytes::check);
}
