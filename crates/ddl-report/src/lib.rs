#![doc = include_str!("../README.md")]

mod document;
mod error;
pub mod figure;
pub mod gallery;
mod literature;
pub mod page;
mod report;
mod snapshot;

pub use error::{MomentFault, ReportError};
pub use report::Report;
pub use snapshot::{ForecastSnapshot, SnapshotHypothesis, SnapshotPedestrian};
