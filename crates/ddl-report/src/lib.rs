#![doc = include_str!("../README.md")]

mod document;
mod error;
pub mod figure;
pub mod gallery;
mod literature;
pub mod page;
mod report;
mod snapshot;
mod training_curve;

pub use document::Table;
pub use error::ReportError;
pub use figure::FigureError;
pub use report::{Report, Summary};
pub use snapshot::{ForecastSnapshot, Highlight, HighlightKind, SnapshotHypothesis, SnapshotPedestrian};
pub use training_curve::{EpochPoint, TrainingCurve};
