//! Intervals and tests of differences that account for the overlap of windows.
//!
//! Neighbouring windows share most of their pedestrians, so the unit is a *block*: all windows of a recording that
//! start within the same 20 s (50 steps). Errors are summed by block and resampled within each fold.
//!
//! # References
//! Künsch, "The jackknife and the bootstrap for general stationary observations", Annals of Statistics 1989 (blocks);
//! Efron, Tibshirani, "An Introduction to the Bootstrap", 1993 (percentile interval, permutation test).

mod blocks;
mod bootstrap;
mod paired;

pub use blocks::{BlockErrors, block_errors};
pub use bootstrap::{Interval, mean_interval};
pub use paired::{PairedDifference, paired_difference};
