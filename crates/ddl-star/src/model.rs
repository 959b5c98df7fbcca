//! The forecasting network on libtorch's tensors.

mod attention;
mod backend;
mod batch;
mod dropout;
mod emission;
mod flow;
mod forecaster;
mod goal_frame;
mod guidance;
mod neighbours;
mod network;
mod numbers;
mod own_motion;
mod packing;
mod parameters;
mod rollout;
mod scene_means;
mod shared_weights;
mod tensor_backend;

pub use backend::TorchBackend;
pub use batch::SceneBatch;
pub use emission::NoiseInput;
pub use flow::{FlowConstants, StepBounds, bounded_step, natural_gradient_step};
pub(crate) use network::Layers;
pub use network::TorchNetwork;
pub(crate) use numbers::{numbers, tensor};
pub use parameters::Parameters;
pub use rollout::Rollout;
pub(crate) use tensor_backend::{KernelPass, Pass};
