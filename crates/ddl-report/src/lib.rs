#![doc = include_str!("../README.md")]

pub mod document;
mod error;
pub mod figure;
pub mod gallery;
pub mod literature;
pub mod page;
mod report;
mod snapshot;
mod training_curve;

pub use error::ReportError;
pub use figure::FigureError;
pub use report::{Report, Summary};
pub use snapshot::{ForecastSnapshot, SnapshotHypothesis, SnapshotPedestrian};
pub use training_curve::{EpochPoint, TrainingCurve};
