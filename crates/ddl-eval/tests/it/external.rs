//! Forecasts of another program: all formats read the same, and errors name their place.

mod files;
mod laws;
mod matching;
mod mistakes;
mod samples;
