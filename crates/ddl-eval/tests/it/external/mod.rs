//! Forecasts of another program: every format reads the same, and every mistake is named with its place.

mod files;
mod laws;
mod matching;
mod mistakes;
