#![doc = include_str!("../README.md")]

mod device;
mod error;
mod model;
mod proposal;
mod training;

pub use device::{ComputeDevice, LIBTORCH_VERSION, set_threads};
pub use error::StarError;
pub use model::{
    FlowConstants, NoiseInput, Parameters, Rollout, SceneBatch, StepBounds, TorchBackend,
    TorchNetwork, bounded_step, natural_gradient_step,
};
pub use proposal::{ProposalTrainer, TorchProposals};
pub use training::{Trainer, mean_distance, mean_squared_distance};
