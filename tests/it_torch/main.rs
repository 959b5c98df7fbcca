//! Tests across crates that need libtorch, and those of the program `ddl`.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

mod bounded_motion;
mod builtin;
mod certificates;
mod convergence;
mod errors;
mod evaluate_report;
mod examples;
mod forecast_own_tracks;
mod goals_and_info;
mod goals_measured;
mod guide;
mod keep_clear;
mod leak;
mod leak_in_reports;
mod live;
mod live_program;
mod manners;
mod other_program;
mod outside_bytes;
mod outside_recordings;
mod own_recordings;
mod own_training;
mod packed;
mod precision;
mod prepare;
mod real_recordings;
mod recipes;
mod start_up;
mod tracks_as_they_come;
mod train_resume;
mod training_memory;
mod view;
