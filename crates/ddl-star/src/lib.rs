#![doc = include_str!("../README.md")]
//!
//! [`TorchNetwork::into_forecaster`] and [`TorchProposals::into_proposer`] implement the traits of `ddl-network` with
//! libtorch, on CUDA or as a reference for the CPU kernels.
//!
//! ## Propose endpoints
//!
//! ```rust
//! use ddl_network::{
//!     DeviceChoice, PedestrianView, ProposalConfig, ProposalExample, ProposalNetwork,
//!     ProposalTraining, ProposeEndpoints,
//! };
//! use ddl_star::{ComputeDevice, ProposalTrainer, TorchProposals};
//!
//! // Pedestrians at several speeds who keep their velocity, in their own frames.
//! let example = |k: u8| {
//!     let step = 0.3 + 0.02 * f64::from(k);
//!     let own = std::array::from_fn(|t| [step * (t as f64 - 7.0), 0.0]);
//!     let future = std::array::from_fn(|t| [step * (t as f64 + 1.0), 0.0]);
//!     ProposalExample { view: PedestrianView { own, neighbours: Vec::new(), remembered: Vec::new() }, future }
//! };
//! let examples: Vec<_> = (0..20).map(example).collect();
//!
//! let config = ProposalConfig { members: 2, ends: 5, width: 32, ..ProposalConfig::default() };
//! let network = TorchProposals::new(config.clone(), 1, ComputeDevice::open(DeviceChoice::Cpu)?)?;
//! let training = ProposalTraining { steps: 150, batch: 32, ..ProposalTraining::default() };
//! let mut trainer = ProposalTrainer::new(network, &examples, &[], training)?;
//! while !trainer.is_finished() {
//!     trainer.step()?;
//! }
//! let weights = trainer.into_network()?.parameters().to_weights()?;
//!
//! let network = ProposalNetwork::reading(config, |_| Ok(weights))?; // without libtorch
//! let proposed = network.propose(&[examples[10].view.clone()])?.remove(0);
//! assert_eq!(proposed.endpoints.len(), 2 * 5); // metres ahead, metres to the left; with weights
//! let off = |end: &[f64; 2]| (end[0] - examples[10].future[11][0]).hypot(end[1]);
//! assert!(proposed.endpoints.iter().map(off).fold(f64::INFINITY, f64::min) < 1.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! ## State of a training
//!
//! [`Trainer::save`] and [`ProposalTrainer::save`] write weights, Adam's moments and the progress into one safetensors
//! file, which holds only numbers and is renamed when complete. `resume` refuses a file that is damaged or of another
//! run, and leaves the training as it was. A resumed run ends with the same weights, bit for bit, as an uninterrupted
//! one on the same machine.
//!
//! ## Devices and threads
//!
//! [`ComputeDevice::open`] comes first: CUDA can be opened only before the first tensor is made. Without CUDA, `Cuda`
//! is an error and `Auto` takes the CPU. [`set_threads`] sets libtorch's threads for the process. Set one on the CPU:
//! training computes parts of a batch on rayon's threads, with the same results for every number of them. It seeds
//! libtorch's process-wide generator at every step, for jitter and dropout.

#[cfg(target_os = "linux")]
mod cuda_graph;
mod device;
mod error;
mod model;
mod proposal;
mod training;

pub use device::{ComputeDevice, LIBTORCH_VERSION, set_threads};
pub use error::{CudaFault, StarError};
pub use model::{Parameters, TorchBackend, TorchNetwork};
pub use proposal::{ProposalTrainer, TorchProposals};
pub use training::Trainer;
