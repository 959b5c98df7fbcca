//! Recordings, windows and folds: laws, and numbers computed outside this project.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod clock;
mod doubt;
mod exchange;
mod folds;
mod formats;
mod frames;
mod homography;
mod live;
mod mistakes;
mod names;
mod observe;
mod observe_reference;
mod readers;
mod recordings;
mod summary;
mod window_counts;
mod windows;
