//! Tests of the public interface.

#![allow(clippy::unwrap_used, reason = "a helper that fails is a test that fails")]

mod figure;
mod gallery;
mod page;
mod pictures;
mod report;
