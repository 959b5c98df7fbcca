//! The goals of a pedestrian: laws, and numbers computed outside this project.
#![allow(
    clippy::unwrap_used,
    clippy::float_cmp,
    clippy::print_stdout,
    reason = "a test may panic, claims exact values, and says what it measured"
)]

mod analogues;
mod estimator;
mod heading;
mod of_ends;
mod published;
mod star_files;
mod tracks;
