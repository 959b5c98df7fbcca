#![doc = include_str!("../README.md")]

mod energy;
mod error;
mod futures;
mod groups;
mod hypotheses;
mod keeping_apart;
mod mixture;
mod pairs;
mod plan;
mod quantisation;
mod sampling;

pub use error::{PlanError, SceneError};
pub use futures::Futures;
pub use groups::groups;
pub use mixture::JointMixture;
pub use plan::{Plan, PlanPoint};
