#![doc = include_str!("../README.md")]

mod error;
#[cfg(test)]
mod fixture;
mod futures;
mod occupancy;
mod plan;
mod risk;

pub use error::{PlanError, SceneError};
pub use futures::Futures;
pub use occupancy::{Area, Occupancy};
pub use plan::{Plan, PlanPoint};
pub use risk::{Clearance, Risk};
