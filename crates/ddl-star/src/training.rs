//! Training of the forecasting network.

pub(crate) mod checkpoint;
mod draws;
mod gradient;
mod loss;
pub(crate) mod optimizer;
mod prepared;
#[cfg(target_os = "linux")]
mod recorded;
mod schedule;
mod trainer;

#[cfg(test)]
pub(crate) use loss::{mean_distance, mean_squared_distance};
use std::sync::Mutex;
pub use trainer::Trainer;

/// libtorch has one generator per process: concurrent trainings take turns to draw from it.
pub(crate) static GENERATOR: Mutex<()> = Mutex::new(());
