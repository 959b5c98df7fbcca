//! Training of the network that proposes where a pedestrian will be at the end of the horizon, on libtorch.

mod augment;
mod data;
mod loss;
mod network;
mod trainer;

pub use network::TorchProposals;
pub use trainer::ProposalTrainer;
