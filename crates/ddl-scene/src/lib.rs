#![doc = include_str!("../README.md")]

mod error;
mod futures;
mod plan;

pub use error::{PlanError, SceneError};
pub use futures::Futures;
pub use plan::{Plan, PlanPoint};
