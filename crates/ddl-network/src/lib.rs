#![doc = include_str!("../README.md")]
#![cfg_attr(
    not(feature = "training"),
    allow(dead_code, reason = "only training uses the backward passes")
)]

pub mod backbone;
pub mod backend;
mod config;
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
    BackboneKind, LearningRateSchedule, MemoryConfig, MemoryTraining, NetworkFrame, Objective,
    ProposalConfig, ProposalTraining, StarConfig, TrainingConfig, Variant,
};
pub use error::NetworkError;
pub use forecast::{
    BatchRollout, ForecastBatch, ForecastWindows, MotionNetwork, Noise, StepRule, WindowRollout,
    motion_bounds, motion_unit, visibility,
};
pub use precision::{DeviceChoice, Precision};
pub use proposal::{PedestrianView, ProposalExample, ProposalNetwork, ProposeEnds, ProposedEnds};
pub use training_report::{EpochReport, ProposalStep, StepReport};
