//! Tests of the public interface.

#![allow(clippy::unwrap_used, reason = "a helper that fails is a test that fails")]

mod external;
mod generated;
mod laws;
mod reference;
