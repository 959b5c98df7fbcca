#![doc = include_str!("../README.md")]

mod energy;
mod error;
#[cfg(test)]
mod fixture;
mod futures;
mod groups;
mod hypotheses;
mod keeping_apart;
mod mixture;
mod occupancy;
mod pairs;
mod parts;
mod plan;
mod quantisation;
mod risk;
mod sampling;

pub use error::{PlanError, SceneError};
pub use futures::Futures;
pub use groups::groups;
pub use mixture::{JointMixture, JointScene};
pub use occupancy::{Area, Occupancy};
pub use parts::{ScenePart, SceneParts};
pub use plan::{Plan, PlanDoubt, PlanPoint};
pub use risk::{Clearance, Risk};
