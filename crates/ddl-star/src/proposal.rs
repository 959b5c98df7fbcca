//! Training of the network that proposes endpoints, on libtorch.

mod augment;
mod data;
mod loss;
mod network;
mod trainer;

pub use network::TorchProposals;
pub use trainer::ProposalTrainer;
