//! A small network that proposes where a walker will be at the end of the horizon.
//!
//! It sees what the retrieval of similar walkers sees, one walker in the walker's own frame, and the
//! walkers nearby. An ensemble of members, each with K ends, is trained so that the nearest of the K
//! ends comes close to the true one ("winner takes all"): the K ends then lie where an error that
//! counts only the nearest of them is smallest. Trained in a minute or two on one core.

mod affine;
mod augment;
mod checkpoint;
mod config;
mod data;
mod loss;
mod network;
mod trainer;

pub use config::{ProposalConfig, ProposalTraining};
pub use data::{ProposalExample, WalkerView};
pub use network::{ProposalNetwork, ProposedEnds};
pub use trainer::{ProposalStep, ProposalTrainer};
