//! Attention without libtorch: only the pairs of walkers that share a scene are computed, and what passes between two
//! products stays in the cache.
//!
//! Sixteen numbers go through each operation together: eight heads each of two walkers. The kernels are plain loops over
//! arrays of sixteen, written once as a [`Kernel`](instruction_set::Kernel) and compiled for each instruction set;
//! [`Dispatch::run`](instruction_set::Dispatch::run) picks the one that was chosen. What is `unsafe` lies in that module.

mod among_walkers;
mod dropout;
mod exp2;
mod heads;
mod instruction_set;
mod lanes;
mod over_memory;
mod scenes;
#[cfg(test)]
mod tests;

pub use among_walkers::{AmongWalkers, Attended};
pub use dropout::Dropout;
pub use instruction_set::InstructionSet;
pub use over_memory::{KeyValue, KeyValueMut, OverMemory, OverMemoryGradients};
pub use scenes::{Frames, Scenes};
