#![doc = include_str!("../README.md")]

pub mod document;
mod error;
pub mod figure;
pub mod gallery;
pub mod literature;
mod moment;
pub mod page;
mod report;
mod training_curve;

pub use error::ReportError;
pub use figure::FigureError;
pub use moment::{Moment, MomentHypothesis, MomentPedestrian};
pub use report::{Report, Summary};
pub use training_curve::{EpochPoint, TrainingCurve};
