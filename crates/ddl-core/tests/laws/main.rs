//! Tests of the public interface.

#![allow(clippy::unwrap_used, reason = "a helper that fails is a test that fails")]

mod adaptive;
mod forecast;
mod representative;
mod window;
