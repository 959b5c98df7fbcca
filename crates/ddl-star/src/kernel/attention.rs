//! Attention without libtorch: only the pairs of walkers that share a scene are computed, and what passes between two
//! products stays in the cache.
//!
//! Sixteen numbers go through each operation together: eight heads each of two walkers. A computation is written once, as
//! a `Kernel`, for any `Simd`; `Dispatch::run` compiles it
//! for each instruction set and picks the one that was chosen. What is `unsafe` lies in one module.

mod among_walkers;
mod dropout;
mod exp2;
mod heads;
mod instruction_set;
mod lanes;
mod over_memory;
mod portable;
mod scenes;
mod simd;
#[cfg(test)]
mod tests;
#[cfg(target_arch = "x86_64")]
mod x86;

pub use among_walkers::{AmongWalkers, Attended};
pub use dropout::Dropout;
pub use instruction_set::InstructionSet;
pub use over_memory::{KeyValue, KeyValueMut, OverMemory, OverMemoryGradients};
pub use scenes::{Frames, Scenes};
