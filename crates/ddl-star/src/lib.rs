#![doc = include_str!("../README.md")]

mod attention;
mod batch;
mod checkpoint;
mod config;
mod device;
mod dropout;
mod encoder_layer;
mod error;
mod flow;
mod forecast;
mod kernel;
mod layers;
mod loss;
mod neighbours;
mod numbers;
mod optimizer;
mod parameters;
mod pass;
mod precision;
mod proposal;
mod remembered;
mod rollout;
mod schedule;
mod seed;
mod spatial;
mod star;
mod tape;
mod temporal;
mod train;
mod training_config;

pub use batch::SceneBatch;
pub use checkpoint::{load_parameters, save_parameters};
pub use config::{StarConfig, Variant};
pub use device::{ComputeDevice, DeviceChoice, set_threads};
pub use error::StarError;
pub use flow::{FlowConstants, StepRule, natural_gradient_step};
pub use forecast::{Noise, WindowRollout};
pub use layers::Mode;
pub use loss::mean_squared_distance;
pub use parameters::Parameters;
pub use precision::Precision;
pub use proposal::{
    ProposalConfig, ProposalExample, ProposalNetwork, ProposalStep, ProposalTrainer,
    ProposalTraining, ProposedEnds, WalkerView,
};
pub use rollout::Rollout;
pub use star::{NoiseInput, StarNetwork};
pub use train::{EpochReport, StepReport, Trainer};
pub use training_config::{LearningRateSchedule, TrainingConfig};
