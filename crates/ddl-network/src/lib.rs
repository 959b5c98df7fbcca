#![doc = include_str!("../README.md")]
#![cfg_attr(
    not(feature = "training"),
    allow(dead_code, reason = "kernels backwards are for training alone")
)]

mod arithmetic;
pub mod backbone;
pub mod backend;
mod config;
mod device_choice;
mod error;
mod forecast;
mod kernel;
mod names;
mod precision;
pub mod proposal;
pub mod seed;
mod training_report;
pub mod weights;

pub use config::{
    BackboneKind, LearningRateSchedule, NetworkFrame, Objective, ProposalConfig, ProposalTraining,
    StarConfig, TrainingConfig, Variant,
};
pub use device_choice::DeviceChoice;
pub use error::NetworkError;
pub use forecast::{
    BatchRollout, ForecastBatch, ForecastWindows, MotionNetwork, Noise, StepRule, WindowRollout,
    motion_bounds, motion_unit, visibility,
};
pub use precision::Precision;
pub use proposal::{PedestrianView, ProposalExample, ProposalNetwork, ProposeEnds, ProposedEnds};
pub use training_report::{EpochReport, ProposalStep, StepReport};
