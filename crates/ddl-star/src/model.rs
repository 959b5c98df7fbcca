//! The forecasting network on libtorch's tensors.
//!
//! Shapes: T time steps; P pedestrians of all windows of a batch, concatenated; H hypotheses. Positions are in metres,
//! time steps 0.4 s apart.

mod attention;
mod attention_blocks;
mod backend;
mod batch;
mod emission;
mod flow;
mod forecaster;
mod goal_frame;
mod guidance;
mod network;
mod numbers;
mod own_motion;
mod parameters;
mod rollout;
mod scene_rows;
mod shared_weights;
mod tensor_backend;

pub use backend::TorchBackend;
pub(crate) use batch::WindowBatch;
pub(crate) use emission::NoiseInput;
pub(crate) use network::Layers;
pub use network::TorchNetwork;
pub(crate) use numbers::{arrays, tensor};
pub use parameters::Parameters;
pub(crate) use tensor_backend::{KernelPass, TensorEngine};

#[cfg(test)]
mod published_tests;
