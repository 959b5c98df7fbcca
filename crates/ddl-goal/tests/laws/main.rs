//! Goals: properties, and comparison with numbers computed outside this project.
#![allow(
    clippy::unwrap_used,
    clippy::float_cmp,
    clippy::print_stdout,
    reason = "a test may panic, compare exact values, and print its measurements"
)]

mod analogues;
mod estimator;
mod from_endpoints;
mod heading;
mod published;
mod tracks;
